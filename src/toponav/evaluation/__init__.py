"""Metrics, episodes and their results: the part of the system that sees ground truth.

Sees everything below it and the environments; pictures and commands are built on top of it.
"""
