"""Put the maps that several detectors gave side by side: docs/images/red_kitchen.png.

Run as ``python docs/make_kitchen_sheet.py OUT ...`` with the folders of ``toponav map``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt

SHEET = Path(__file__).parent / "images" / "red_kitchen.png"
PLOT = (0.03, 0.08, 0.97, 0.8)
"""The part of a map's picture without title and legend: left, top, right, bottom shares."""


def main(folders: list[Path]) -> None:
    """One column a folder, which gives it its name."""
    figure, axes = plt.subplots(1, len(folders), figsize=(4.4 * len(folders), 2.7), squeeze=False)
    for cell, folder in zip(axes[0], folders, strict=True):
        picture = Image.open(folder / "topdown.png").convert("RGB")
        width, height = picture.size
        left, top, right, bottom = PLOT
        cell.imshow(
            picture.crop(
                (int(left * width), int(top * height), int(right * width), int(bottom * height))
            )
        )
        cell.set_title(folder.name, fontsize=10)
        cell.set_axis_off()
    figure.tight_layout(pad=0.8)
    figure.savefig(SHEET, dpi=110)


if __name__ == "__main__":
    main([Path(name) for name in sys.argv[1:]])
