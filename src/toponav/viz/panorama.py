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
from toponav.reasoning.vlm.panorama_sheet import FONT_SIZE, PAPER, compose_sheet, sheet_layout

VIEW_WIDTH = 240
"""Pixels a view; a 12-view panorama is then nearly 1000 pixels wide."""
VERDICT_HEIGHT = 34
CHOSEN = (224, 49, 49)
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
    images = [view.image for view in views]
    captions = [_caption(index, view) for index, view in enumerate(views)]
    sheet = compose_sheet(images, captions, VIEW_WIDTH)
    page = Image.new("RGB", (sheet.width, sheet.height + VERDICT_HEIGHT), PAPER)
    page.paste(sheet, (0, 0))
    draw = ImageDraw.Draw(page)
    if guidance is not None:
        layout = sheet_layout(images, captions, VIEW_WIDTH)
        left, top = layout.corner(guidance.direction)
        box = (left, top, left + layout.width - 1, top + layout.height - 1)
        draw.rectangle(box, outline=CHOSEN, width=4)
    font = ImageFont.load_default(size=FONT_SIZE)
    draw.text((4, sheet.height + 8), _verdict(guidance, target), fill=CHOSEN, font=font)
    return page


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
