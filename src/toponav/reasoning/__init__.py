"""TODO-DOC reasoning."""
