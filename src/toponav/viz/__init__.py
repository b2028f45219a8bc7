"""TODO-DOC viz."""
