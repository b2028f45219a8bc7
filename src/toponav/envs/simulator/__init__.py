"""TODO-DOC envs/simulator."""
