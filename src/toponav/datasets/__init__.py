"""TODO-DOC datasets."""
