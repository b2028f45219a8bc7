"""Names and sizes of the assets that ProcTHOR houses are furnished with.

A house file names its assets and says where their centres are; their meshes, and so their sizes,
lie elsewhere. Heights follow from the centres of what stands on a floor; widths and depths are
typical of the category.
"""

from __future__ import annotations

import re

from toponav.categories import canonical

FOOT_M = 0.3048
"""The names of counters give their sides in feet."""

# Asset names by words, where `canonical` would not know them.
_CATEGORIES = {
    "wall_decor_painting": "picture",
    "wall_decor_photo": "picture",
    "wall_decor": "picture",
    "tv_stand": "tv_stand",
    "tvstand": "tv_stand",
    "house_plant": "plant",
    "side_table": "table",
    "shelving_unit": "bookshelf",
    "countertop_cx": "counter",
    "countertop_lx": "counter",
    "countertop_ix": "counter",
    "countertop_c": "counter",
    "countertop_l": "counter",
    "countertop_i": "counter",
    "counter_top": "counter",
    "garbage_bag": "garbage_bag",
    "arm_chair": "chair",
    "dining_table_extendable": "table",
    "bedkritter": "bed",
    "bedhemnes": "bed",
    "desk_lamp": "lamp",
    "bathroom_faucet": "faucet",
    "ottoman": "stool",
    "clothes_dryer": "dryer",
    "stove_burner": "oven",
    "sofa_chair": "chair",
}

# Width, depth and height in metres, as common furniture catalogues give them.
_SIZES = {
    "bed": (1.4, 2.0, 0.9),
    "sofa": (1.9, 0.9, 0.85),
    "chair": (0.5, 0.52, 0.88),
    "table": (1.2, 0.8, 0.76),
    "coffee_table": (1.1, 0.6, 0.42),
    "desk": (1.3, 0.65, 0.76),
    "chest_of_drawers": (1.0, 0.48, 0.9),
    "nightstand": (0.48, 0.42, 0.55),
    "tv_stand": (1.4, 0.42, 0.6),
    "tv_monitor": (1.1, 0.1, 0.65),
    "fridge": (0.8, 0.75, 1.8),
    "toilet": (0.42, 0.7, 0.9),
    "sink": (0.6, 0.5, 0.95),
    "bathtub": (0.8, 1.7, 0.6),
    "counter": (1.8, 0.62, 0.94),
    "bookshelf": (0.9, 0.38, 1.8),
    "plant": (0.45, 0.45, 0.8),
    "stool": (0.42, 0.42, 0.6),
    "lamp": (0.3, 0.3, 0.5),
    "picture": (0.7, 0.04, 0.5),
    "refuse_bin": (0.3, 0.3, 0.55),
    "garbage_bag": (0.45, 0.45, 0.55),
    "cart": (0.8, 0.45, 0.9),
    "laptop": (0.34, 0.25, 0.22),
    "cushion": (0.5, 0.35, 0.16),
    "book": (0.2, 0.26, 0.04),
    "box": (0.35, 0.3, 0.25),
    "microwave": (0.5, 0.38, 0.3),
    "washing_machine": (0.65, 0.65, 0.9),
    "dryer": (0.65, 0.65, 0.9),
    "dog_bed": (0.8, 0.6, 0.2),
    "laundry_hamper": (0.45, 0.4, 0.6),
    "vacuum_cleaner": (0.35, 0.35, 1.1),
    "safe": (0.4, 0.4, 0.4),
    "plunger": (0.16, 0.16, 0.5),
    "coffee_machine": (0.28, 0.32, 0.36),
    "vase": (0.16, 0.16, 0.3),
    "statue": (0.15, 0.15, 0.35),
    "baseball_bat": (0.08, 0.7, 0.08),
    "tennis_racket": (0.28, 0.68, 0.05),
    "teddy_bear": (0.3, 0.25, 0.35),
    "desktop": (0.5, 0.4, 0.45),
}

_SMALL_THING = (0.12, 0.12, 0.12)
"""Cups, fruit, pens and whatever else has no entry above."""

# Assets that are smaller than most of their category.
_SIZES_BY_NAME = {"side_table": (0.5, 0.45, 0.6)}

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_COUNTER = re.compile(r"Countertop_([A-Z])_(\d+)x(\d+)")


def asset_name(object_id: str) -> str:
    """The asset's name in words: `Chair_201|2|4` is a chair, `RoboTHORbedkritter` a bedkritter."""
    stem = object_id.split("|", maxsplit=1)[0].replace("RoboTHOR", "")
    words = [word.lower() for word in _WORD.findall(stem)]
    if len(words) > 1 and words[-1] in ("v", "h"):
        words.pop()
    return "_".join(words)


def asset_category(object_id: str) -> str:
    """The canonical category of an object, by the asset that its id names."""
    name = asset_name(object_id)
    return canonical(_CATEGORIES.get(name, name))


def typical_size(object_id: str) -> tuple[float, float, float]:
    """Width, depth and height of an object, metres."""
    name = asset_name(object_id)
    return _SIZES_BY_NAME.get(name) or _SIZES.get(asset_category(object_id), _SMALL_THING)


def counter_sides(asset_id: str) -> tuple[str, float, float] | None:
    """Shape (L, C or I) and sides in metres of a counter, from its asset's name."""
    match = _COUNTER.match(asset_id)
    if match is None:
        return None
    return match[1], float(match[2]) * FOOT_M, float(match[3]) * FOOT_M
