"""A renderer on OpenGL, without a display (extra `gl`): colour, depth and ids in one pass."""
