"""The paper's detector, GLEE, from its authors' code and checkpoints where a user has them."""
