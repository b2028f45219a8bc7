"""TODO-DOC control."""
