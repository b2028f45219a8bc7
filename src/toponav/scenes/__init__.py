"""TODO-DOC scenes."""
