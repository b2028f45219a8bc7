"""One small house for all command tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from toponav.scenes.generate import generate_house
from toponav.scenes.house_io import save_house


@pytest.fixture(scope="session")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("houses") / "small.json"
    save_house(generate_house(6), path)
    return path
