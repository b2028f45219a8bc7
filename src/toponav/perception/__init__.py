"""TODO-DOC perception."""
