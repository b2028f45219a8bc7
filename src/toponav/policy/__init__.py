"""TODO-DOC policy."""
