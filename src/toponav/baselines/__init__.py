"""TODO-DOC baselines."""
