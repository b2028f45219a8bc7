"""TODO-DOC mapping."""
