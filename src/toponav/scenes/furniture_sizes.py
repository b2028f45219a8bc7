"""Typical sizes of furniture: what the generator and the importers draw from.

Each entry gives the range of width (along the wall), depth (out of it) and height in metres, as
furniture shops list them.
"""

from __future__ import annotations

import numpy as np

Range = tuple[float, float]
Extents = tuple[float, float, float]

SIZE_RANGES: dict[str, tuple[Range, Range, Range]] = {
    "bathtub": ((1.5, 1.7), (0.7, 0.8), (0.5, 0.6)),
    "bed": ((1.4, 1.8), (1.95, 2.1), (0.85, 1.1)),
    "bench": ((1.0, 1.4), (0.35, 0.45), (0.42, 0.48)),
    "bicycle": ((1.6, 1.75), (0.45, 0.55), (1.0, 1.1)),
    "book": ((0.15, 0.2), (0.2, 0.26), (0.03, 0.06)),
    "bookshelf": ((0.7, 1.1), (0.28, 0.36), (1.6, 2.1)),
    "box": ((0.35, 0.55), (0.3, 0.45), (0.3, 0.45)),
    "cabinet": ((0.8, 1.4), (0.4, 0.5), (0.8, 1.4)),
    "car": ((4.0, 4.5), (1.7, 1.85), (1.4, 1.55)),
    "chair": ((0.42, 0.5), (0.45, 0.54), (0.85, 1.0)),
    "chest_of_drawers": ((0.8, 1.2), (0.42, 0.5), (0.8, 1.1)),
    "clothes": ((0.9, 1.4), (0.45, 0.55), (1.5, 1.7)),
    "coffee_table": ((0.8, 1.1), (0.5, 0.6), (0.38, 0.46)),
    "counter": ((1.4, 2.6), (0.6, 0.64), (0.88, 0.94)),
    "cushion": ((0.4, 0.48), (0.14, 0.2), (0.38, 0.45)),
    "desk": ((1.1, 1.5), (0.6, 0.75), (0.72, 0.76)),
    "dishwasher": ((0.6, 0.6), (0.6, 0.62), (0.85, 0.88)),
    "dryer": ((0.6, 0.6), (0.6, 0.64), (0.85, 0.88)),
    "fireplace": ((1.2, 1.5), (0.4, 0.5), (1.1, 1.3)),
    "fridge": ((0.6, 0.8), (0.64, 0.7), (1.6, 1.9)),
    "gym_equipment": ((0.7, 0.8), (1.5, 1.8), (1.2, 1.4)),
    "lamp": ((0.34, 0.44), (0.34, 0.44), (1.4, 1.7)),
    "laptop": ((0.32, 0.36), (0.24, 0.26), (0.22, 0.24)),
    "microwave": ((0.45, 0.5), (0.36, 0.4), (0.27, 0.3)),
    "mirror": ((0.5, 0.8), (0.03, 0.05), (0.7, 1.0)),
    "nightstand": ((0.4, 0.5), (0.38, 0.45), (0.5, 0.6)),
    "oven": ((0.6, 0.6), (0.6, 0.62), (0.88, 0.92)),
    "piano": ((1.4, 1.5), (0.55, 0.62), (1.1, 1.25)),
    "picture": ((0.5, 1.0), (0.03, 0.05), (0.4, 0.7)),
    "plant": ((0.4, 0.6), (0.4, 0.6), (0.8, 1.4)),
    "refuse_bin": ((0.26, 0.34), (0.26, 0.34), (0.35, 0.6)),
    "rug": ((1.4, 2.2), (1.0, 1.6), (0.012, 0.016)),
    "seating": ((1.2, 1.6), (0.5, 0.6), (0.45, 0.5)),
    "shoe_rack": ((0.7, 0.9), (0.3, 0.34), (0.5, 0.7)),
    "shower": ((0.85, 0.95), (0.85, 0.95), (2.0, 2.1)),
    "sink": ((0.55, 0.8), (0.45, 0.5), (0.85, 0.92)),
    "sofa": ((1.7, 2.3), (0.85, 0.95), (0.78, 0.88)),
    "stool": ((0.34, 0.4), (0.34, 0.4), (0.6, 0.7)),
    "table": ((1.2, 1.8), (0.8, 0.95), (0.73, 0.77)),
    "toilet": ((0.38, 0.42), (0.66, 0.72), (0.76, 0.84)),
    "towel": ((0.45, 0.6), (0.06, 0.08), (0.7, 0.9)),
    "tv_monitor": ((0.9, 1.3), (0.16, 0.22), (0.58, 0.8)),
    "tv_stand": ((1.3, 1.7), (0.38, 0.45), (0.42, 0.52)),
    "wardrobe": ((1.0, 1.8), (0.55, 0.62), (1.9, 2.2)),
    "washing_machine": ((0.6, 0.6), (0.58, 0.62), (0.85, 0.88)),
    "workbench": ((1.4, 1.9), (0.6, 0.7), (0.9, 1.0)),
}

UNKNOWN_SIZE: tuple[Range, Range, Range] = ((0.4, 0.8), (0.4, 0.6), (0.4, 0.9))


def draw_size(category: str, rng: np.random.Generator) -> Extents:
    """Width, depth and height of a piece of furniture, metres, to the centimetre."""
    ranges = SIZE_RANGES.get(category, UNKNOWN_SIZE)
    width, depth, height = (round(float(rng.uniform(*span)), 3) for span in ranges)
    return width, depth, height
