"""Hypothesis without deadlines: a shared machine may be slow, and the first call compiles."""

from hypothesis import settings

settings.register_profile("toponav", deadline=None)
settings.load_profile("toponav")
