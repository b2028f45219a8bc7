"""Hypothesis without deadlines: a shared machine may be slow, and the first call compiles.

In CI the same examples are tried every time, so that a change is judged by what it changes.
"""

import os

from hypothesis import settings

settings.register_profile("toponav", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("toponav")
