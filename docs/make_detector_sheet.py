"""Draw what three detectors see in photographs: docs/images/detectors.jpg.

Run as ``python docs/make_detector_sheet.py PHOTOS_FOLDER MODEL.onnx ...``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from toponav.categories import DEFAULT_VOCABULARY, readable
from toponav.perception import DetectorContext, PerceptionConfig, make_detector

SHEET = Path(__file__).parent / "images" / "detectors.jpg"
WIDTH_PX = 480


def main(folder: Path, models: list[Path]) -> None:
    """One row a model, one column a photograph."""
    photos = sorted(path for path in folder.iterdir() if path.suffix in (".jpg", ".png"))
    figure, axes = plt.subplots(
        len(models), len(photos), figsize=(4 * len(photos), 3.1 * len(models)), squeeze=False
    )
    for row, model in zip(axes, models, strict=True):
        detector = make_detector(f"onnx:{model}", DetectorContext(PerceptionConfig()))
        for cell, photo in zip(row, photos, strict=True):
            image = Image.open(photo).convert("RGB")
            image.thumbnail((WIDTH_PX, WIDTH_PX))
            rgb = np.asarray(image)
            seen = detector.detect(rgb, DEFAULT_VOCABULARY)
            cell.imshow(rgb)
            for label, score, (left, top, right, bottom) in zip(
                seen.labels, seen.scores, seen.boxes, strict=True
            ):
                size = (right - left, bottom - top)
                cell.add_patch(plt.Rectangle((left, top), *size, fill=False, ec="w", lw=2.5))
                cell.add_patch(plt.Rectangle((left, top), *size, fill=False, ec="C3", lw=1.2))
                note = f"{readable(label)} {score:.2f}"
                style = {"facecolor": "C3", "edgecolor": "none", "pad": 1.0}
                cell.text(left + 2, top + 9, note, color="w", fontsize=7, bbox=style)
            cell.set_axis_off()
        row[0].set_title(model.stem, loc="left", fontsize=9)
    figure.tight_layout(pad=0.4)
    figure.savefig(SHEET, dpi=80, pil_kwargs={"quality": 85})


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
