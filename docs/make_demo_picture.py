"""Draws docs/images/demo.png and docs/images/demo.gif: the search that `toponav demo` makes."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from toponav.cli.main import main

IMAGES = Path(__file__).parent / "images"


def draw() -> None:
    """Run the demo, keep its picture and film it."""
    with tempfile.TemporaryDirectory() as folder:
        if main(["demo", "--out", folder]) != 0:
            raise SystemExit("the demo failed; its message is above")
        IMAGES.mkdir(exist_ok=True)
        shutil.copy(Path(folder) / "topdown.png", IMAGES / "demo.png")
        film = ["--what", "video", "--every", "2", "--out", str(IMAGES / "demo.gif")]
        if main(["render", folder, *film]) != 0:
            raise SystemExit("the film failed; the message is above")


if __name__ == "__main__":
    draw()
