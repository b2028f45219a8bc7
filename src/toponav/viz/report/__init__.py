"""The explorer: runs as one self-contained page, from what they recorded."""
