"""How many tokens a prompt takes, before it is sent."""

from __future__ import annotations

import math

CHARACTERS_PER_TOKEN = 3.5
"""English prose has about 4; lists of names and numbers have fewer."""

LOW_DETAIL_TOKENS = 85
TILE_TOKENS = 170
TILE = 512
LONGEST_SIDE, SHORTEST_SIDE = 2048, 768
"""GPT-4o's rule for images: fit into 2048 x 2048, shrink the shorter side to 768, count tiles."""


def text_tokens(text: str) -> int:
    """Tokens of a text, estimated on the high side."""
    return math.ceil(len(text) / CHARACTERS_PER_TOKEN)


def image_tokens(width: int, height: int, detail: str) -> int:
    """Tokens of an image by GPT-4o's rule; other models differ.

    Args:
        width: Pixels.
        height: Pixels.
        detail: "low" or "high".
    """
    if detail == "low":
        return LOW_DETAIL_TOKENS
    scale = min(1.0, LONGEST_SIDE / max(width, height), SHORTEST_SIDE / min(width, height))
    tiles = math.ceil(width * scale / TILE) * math.ceil(height * scale / TILE)
    return LOW_DETAIL_TOKENS + TILE_TOKENS * tiles
