"""TODO-DOC memory."""
