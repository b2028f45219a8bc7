"""Where tests find the data that is not part of the repository."""

from pathlib import Path

import pytest

SHARED_DATA = Path(__file__).resolve().parents[1] / ".." / "shared" / "data"


def shared_data(relative: str) -> Path:
    """The path of a file or folder of the shared data; skips the test where there is none."""
    path = SHARED_DATA / relative
    if not path.exists():
        pytest.skip(f"no shared data at {path}")
    return path


def shared_model(name: str) -> Path:
    """The path of one of the small detectors beside the shared data; skips without it."""
    path = SHARED_DATA.parent / "models" / name
    if not path.exists():
        pytest.skip(f"no model at {path}")
    return path
