"""Draws docs/images/demo.png and docs/images/panorama.jpg: what `toponav demo` writes."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from toponav.cli.main import main

IMAGES = Path(__file__).parent / "images"
PANORAMA = "panorama_01.jpg"
"""The second decision: the first at which the memory holds more than the start."""


def draw() -> None:
    """Run the demo and keep its pictures."""
    with tempfile.TemporaryDirectory() as folder:
        if main(["demo", "--out", folder]) != 0:
            raise SystemExit("the demo failed; its message is above")
        IMAGES.mkdir(exist_ok=True)
        shutil.copy(Path(folder) / "topdown.png", IMAGES / "demo.png")
        shutil.copy(Path(folder) / PANORAMA, IMAGES / "panorama.jpg")


if __name__ == "__main__":
    draw()
