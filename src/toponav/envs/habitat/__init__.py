"""Habitat-Sim behind the environment seam, and its navmesh files; the library loads on use."""
