"""TODO-DOC envs."""
