"""Views side by side on one sheet, each with its caption."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

COLUMNS = 4
INK = (33, 37, 41)
PAPER = (255, 255, 255)
LINE_HEIGHT = 15
FONT_SIZE = 12
GAP = 6
"""Pixels between images: neighbours must not look like one."""


@dataclass(frozen=True)
class SheetLayout:
    """Where the images of a sheet lie.

    Attributes:
        count: Images.
        width: Pixels of one.
        height: Pixels of one.
        lines: Lines of each caption.
    """

    count: int
    width: int
    height: int
    lines: int

    @property
    def columns(self) -> int:
        """Images in a row."""
        return min(COLUMNS, self.count)

    @property
    def size(self) -> tuple[int, int]:
        """Pixels of the whole sheet."""
        rows = math.ceil(self.count / self.columns)
        return self.columns * (self.width + GAP) - GAP, rows * self._row_height

    def corner(self, index: int) -> tuple[int, int]:
        """Left and top of an image."""
        row, column = divmod(index, self.columns)
        return column * (self.width + GAP), row * self._row_height

    @property
    def _row_height(self) -> int:
        return self.height + self.lines * LINE_HEIGHT + GAP


def sheet_layout(
    images: Sequence[NDArray[np.uint8]], captions: Sequence[Sequence[str]], width: int
) -> SheetLayout:
    """The layout of one or more (H, W, 3) images of one size; all captions have as many lines."""
    height = round(width * images[0].shape[0] / images[0].shape[1])
    return SheetLayout(len(images), width, height, len(captions[0]))


def compose_sheet(
    images: Sequence[NDArray[np.uint8]], captions: Sequence[Sequence[str]], width: int
) -> Image.Image:
    """The images in rows, in order, with their captions below them.

    Args:
        images: One or more (H, W, 3) uint8 of one size.
        captions: The lines below each image; all have as many.
        width: Pixels of one image on the sheet.
    """
    layout = sheet_layout(images, captions, width)
    sheet = Image.new("RGB", layout.size, PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=FONT_SIZE)
    for index, (image, lines) in enumerate(zip(images, captions, strict=True)):
        left, top = layout.corner(index)
        sheet.paste(Image.fromarray(image).resize((width, layout.height)), (left, top))
        for number, line in enumerate(lines):
            at = (left + 2, top + layout.height + 2 + number * LINE_HEIGHT)
            draw.text(at, line, fill=INK, font=font)
    return sheet
