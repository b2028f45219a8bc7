"""Names of things: the datasets' targets, everyday objects, and the spellings people use.

Every name that enters the system (a goal, a scene's category, a detector's class) passes through
`canonical` once, at its adapter; inside, equal things have equal names.
"""

from __future__ import annotations

HM3D_TARGETS = ("chair", "bed", "plant", "toilet", "tv_monitor", "sofa")
"""HM3D ObjectNav categories in the order of their task ids."""

MP3D_TARGETS = (
    "chair",
    "table",
    "picture",
    "cabinet",
    "cushion",
    "sofa",
    "bed",
    "chest_of_drawers",
    "plant",
    "sink",
    "toilet",
    "stool",
    "towel",
    "tv_monitor",
    "shower",
    "bathtub",
    "counter",
    "fireplace",
    "gym_equipment",
    "seating",
    "clothes",
)
"""MP3D ObjectNav categories in the order of their task ids."""

CONTEXT_CATEGORIES = (
    "bench",
    "book",
    "bookshelf",
    "box",
    "coffee_table",
    "desk",
    "dishwasher",
    "dryer",
    "fridge",
    "lamp",
    "laptop",
    "microwave",
    "mirror",
    "nightstand",
    "oven",
    "piano",
    "refuse_bin",
    "rug",
    "shoe_rack",
    "stairs",
    "tv_stand",
    "wardrobe",
    "washing_machine",
    "workbench",
    "bicycle",
    "car",
)
"""What else rooms hold that tells them apart; detected for the memory, seldom searched for."""

DEFAULT_VOCABULARY = tuple(dict.fromkeys((*HM3D_TARGETS, *MP3D_TARGETS, *CONTEXT_CATEGORIES)))
"""The categories T that the memory is built from unless a configuration says otherwise."""

# The benchmarks count an armchair as a chair, a flower pot as a plant, a toilet seat as a toilet.
_SYNONYMS = {
    "couch": "sofa",
    "settee": "sofa",
    "loveseat": "sofa",
    "tv": "tv_monitor",
    "television": "tv_monitor",
    "tvmonitor": "tv_monitor",
    "monitor": "tv_monitor",
    "tv_screen": "tv_monitor",
    "potted_plant": "plant",
    "pottedplant": "plant",
    "houseplant": "plant",
    "flower_pot": "plant",
    "armchair": "chair",
    "dining_chair": "chair",
    "office_chair": "chair",
    "desk_chair": "chair",
    "dining_table": "table",
    "diningtable": "table",
    "kitchen_table": "table",
    "dresser": "chest_of_drawers",
    "drawers": "chest_of_drawers",
    "chest": "chest_of_drawers",
    "refrigerator": "fridge",
    "painting": "picture",
    "poster": "picture",
    "bath": "bathtub",
    "bath_tub": "bathtub",
    "washbasin": "sink",
    "basin": "sink",
    "wc": "toilet",
    "toilet_seat": "toilet",
    "pillow": "cushion",
    "bin": "refuse_bin",
    "trash_can": "refuse_bin",
    "garbage_can": "refuse_bin",
    "bedside_table": "nightstand",
    "night_stand": "nightstand",
    "closet": "wardrobe",
    "bookcase": "bookshelf",
    "stove": "oven",
    "cooker": "oven",
    "washer": "washing_machine",
    "kitchen_counter": "counter",
    "countertop": "counter",
    "staircase": "stairs",
    "stair": "stairs",
    "carpet": "rug",
    "floor_lamp": "lamp",
    "table_lamp": "lamp",
    "shelf": "bookshelf",
    "shelving": "bookshelf",
}


def canonical(name: str) -> str:
    """The one spelling of a category name: lower case, underscores, synonyms resolved.

    Free text that is in no table comes back normalised, never rejected.
    """
    key = "_".join(name.strip().lower().replace("-", " ").replace("_", " ").split())
    return _SYNONYMS.get(key, key)


def readable(category: str) -> str:
    """The category as prose: `chest_of_drawers` becomes `chest of drawers`."""
    return category.replace("_", " ")
