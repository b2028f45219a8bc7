"""The panorama of a decision as one image: numbered views, the chosen one marked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from toponav.categories import readable
from toponav.files import temporary_beside
from toponav.reasoning.base import PanoramaView
from toponav.reasoning.schema import Guidance

VIEW_WIDTH = 240
"""Pixels a view; a 12-view panorama is then 960 pixels wide."""
COLUMNS = 4
CAPTION_HEIGHT = 34
CHOSEN = (224, 49, 49)
INK = (33, 37, 41)
PAPER = (255, 255, 255)
MAX_LABELS = 5


def save_panorama(
    views: Sequence[PanoramaView], guidance: Guidance | None, target: str, path: Path
) -> None:
    """Write the views in the order taken, with what was seen, and the reasoner's words below."""
    image = draw_panorama(views, guidance, target)
    temporary = temporary_beside(path)
    image.save(temporary, quality=88)
    temporary.replace(path)


def draw_panorama(
    views: Sequence[PanoramaView], guidance: Guidance | None, target: str
) -> Image.Image:
    """The composed image; `views` is not empty."""
    height, width = views[0].image.shape[:2]
    view_height = round(VIEW_WIDTH * height / width)
    columns = min(COLUMNS, len(views))
    rows = math.ceil(len(views) / columns)
    cell_height = view_height + CAPTION_HEIGHT
    sheet = Image.new("RGB", (columns * VIEW_WIDTH, rows * cell_height + CAPTION_HEIGHT), PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=12)
    for index, view in enumerate(views):
        left, top = index % columns * VIEW_WIDTH, index // columns * cell_height
        thumbnail = Image.fromarray(view.image).resize((VIEW_WIDTH, view_height))
        sheet.paste(thumbnail, (left, top))
        chosen = guidance is not None and guidance.direction == index
        box = (left, top, left + VIEW_WIDTH - 1, top + view_height - 1)
        draw.rectangle(box, outline=CHOSEN if chosen else PAPER, width=4 if chosen else 1)
        caption, seen = _caption(index, view)
        draw.text((left + 4, top + view_height + 2), caption, fill=INK, font=font)
        draw.text((left + 4, top + view_height + 17), seen, fill=INK, font=font)
    draw.text((4, rows * cell_height + 8), _verdict(guidance, target), fill=CHOSEN, font=font)
    return sheet


def _caption(index: int, view: PanoramaView) -> tuple[str, str]:
    """Two short lines: the view's number and bearing, and what was seen nearest."""
    nearest = sorted(view.seen, key=lambda item: item.range_m)
    names = list(dict.fromkeys(readable(item.label) for item in nearest))
    more = f" +{len(names) - MAX_LABELS}" if len(names) > MAX_LABELS else ""
    bearing = math.degrees(view.bearing)
    first = f"{index}: {bearing:+.0f} deg, {view.frontier_count} frontier points"
    return first, ", ".join(names[:MAX_LABELS])[:38] + more


def _verdict(guidance: Guidance | None, target: str) -> str:
    if guidance is None:
        return f"searching for: {readable(target)}"
    found = "found" if guidance.target_found else "not found"
    return (
        f"{readable(target)} {found}; room: {readable(guidance.room_type)}; "
        f"next node {guidance.node_id}, view {guidance.direction}. {guidance.reason}"
    )
