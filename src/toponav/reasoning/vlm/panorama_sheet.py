"""Views side by side on one sheet, each with its caption."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

COLUMNS = 4
INK = (33, 37, 41)
PAPER = (255, 255, 255)
LINE_HEIGHT = 15
FONT_SIZE = 12
MARGIN = 4


def compose_sheet(
    images: Sequence[NDArray[np.uint8]],
    captions: Sequence[Sequence[str]],
    width: int,
    columns: int = COLUMNS,
) -> Image.Image:
    """The images in rows, in order, with their captions below them.

    Args:
        images: One or more (H, W, 3) uint8 of one size.
        captions: The lines below each image; all have as many.
        width: Pixels of one image on the sheet.
        columns: Images in a row.
    """
    height, cell_height = cell_size(images, captions, width)
    columns = min(columns, len(images))
    rows = math.ceil(len(images) / columns)
    sheet = Image.new("RGB", (columns * width, rows * cell_height), PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=FONT_SIZE)
    for index, (image, lines) in enumerate(zip(images, captions, strict=True)):
        left, top = index % columns * width, index // columns * cell_height
        sheet.paste(Image.fromarray(image).resize((width, height)), (left, top))
        for number, line in enumerate(lines):
            at = (left + MARGIN, top + height + 2 + number * LINE_HEIGHT)
            draw.text(at, line, fill=INK, font=font)
    return sheet


def cell_size(
    images: Sequence[NDArray[np.uint8]], captions: Sequence[Sequence[str]], width: int
) -> tuple[int, int]:
    """Pixels of an image's height on the sheet, and of the height of its cell."""
    height = round(width * images[0].shape[0] / images[0].shape[1])
    return height, height + LINE_HEIGHT * len(captions[0]) + MARGIN
