"""Names of things: the datasets' targets, everyday objects, and the spellings people use.

Every name that enters the system (a goal, a scene's category, a detector's class) passes through
`canonical` once, at its adapter; inside, equal things have equal names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

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


@dataclass(frozen=True)
class CategoryNames:
    """One category's row of the vocabulary.

    Attributes:
        spoken: What one says to an open-vocabulary detector.
        spellings: Other names for it: of COCO, Pascal VOC, LVIS, ADE20K, Objects365, HM3D and
            Matterport3D, and of everyday language.
    """

    spoken: str
    spellings: tuple[str, ...] = ()


# The benchmarks count an armchair as a chair, a flower pot as a plant, a toilet seat as a toilet.
VOCABULARY: Mapping[str, CategoryNames] = MappingProxyType(
    {
        "chair": CategoryNames(
            "chair",
            ("armchair", "desk chair", "dining chair", "folding chair", "kitchen chair",
             "office chair", "swivel chair"),
        ),
        "bed": CategoryNames("bed", ("bedstead", "bunk bed")),
        "plant": CategoryNames(
            "potted plant", ("flower pot", "houseplant", "potted plant", "pottedplant")
        ),
        "toilet": CategoryNames("toilet", ("toilet bowl", "toilet seat", "wc")),
        "tv_monitor": CategoryNames(
            "television",
            ("computer monitor", "flat screen", "monitor", "television", "television receiver",
             "television set", "tv", "tv screen", "tvmonitor"),
        ),
        "sofa": CategoryNames(
            "sofa", ("couch", "loveseat", "sectional sofa", "settee", "sofa bed")
        ),
        "table": CategoryNames("table", ("dining table", "diningtable", "kitchen table")),
        "picture": CategoryNames(
            "picture", ("framed picture", "painting", "photo frame", "picture frame", "poster")
        ),
        "cabinet": CategoryNames("cabinet", ("cupboard",)),
        "cushion": CategoryNames("cushion", ("pillow", "throw pillow")),
        "chest_of_drawers": CategoryNames(
            "chest of drawers", ("bureau", "chest", "drawers", "dresser")
        ),
        "sink": CategoryNames("sink", ("basin", "kitchen sink", "washbasin", "wash basin")),
        "stool": CategoryNames("stool", ("bar stool", "barstool", "footstool", "step stool")),
        "towel": CategoryNames("towel", ("bath towel", "hand towel")),
        "shower": CategoryNames("shower", ("shower stall", "shower cabin")),
        "bathtub": CategoryNames("bathtub", ("bath", "bath tub", "tub")),
        "counter": CategoryNames(
            "kitchen counter", ("countertop", "kitchen counter", "kitchen island", "worktop")
        ),
        "fireplace": CategoryNames("fireplace", ("hearth",)),
        "gym_equipment": CategoryNames(
            "gym equipment", ("exercise bike", "exercise equipment", "exercise machine")
        ),
        "seating": CategoryNames("seat", ()),
        "clothes": CategoryNames("clothes", ("apparel", "clothing")),
        "bench": CategoryNames("bench", ()),
        "book": CategoryNames("book", ("books",)),
        "bookshelf": CategoryNames("bookshelf", ("bookcase", "shelf", "shelving")),
        "box": CategoryNames("box", ("cardboard box", "carton")),
        "coffee_table": CategoryNames("coffee table", ("cocktail table",)),
        "desk": CategoryNames("desk", ("writing desk",)),
        "dishwasher": CategoryNames("dishwasher", ()),
        "dryer": CategoryNames("tumble dryer", ("clothes dryer", "tumble dryer")),
        "fridge": CategoryNames("refrigerator", ("freezer", "icebox", "refrigerator")),
        "lamp": CategoryNames("lamp", ("desk lamp", "floor lamp", "table lamp")),
        "laptop": CategoryNames("laptop", ("laptop computer", "notebook computer")),
        "microwave": CategoryNames("microwave oven", ("microwave oven",)),
        "mirror": CategoryNames("mirror", ("looking glass",)),
        "nightstand": CategoryNames("nightstand", ("bedside table", "night stand", "night table")),
        "oven": CategoryNames("oven", ("cooker", "stove")),
        "piano": CategoryNames("piano", ("grand piano", "pianoforte")),
        "refuse_bin": CategoryNames(
            "trash can",
            ("ashcan", "bin", "garbage can", "rubbish bin", "trash bin", "trash can",
             "waste bin", "wastebasket"),
        ),
        "rug": CategoryNames("rug", ("carpet",)),
        "shoe_rack": CategoryNames("shoe rack", ()),
        "stairs": CategoryNames("staircase", ("stair", "staircase", "stairway")),
        "tv_stand": CategoryNames("TV stand", ("television stand", "tv cabinet", "tv unit")),
        "wardrobe": CategoryNames("wardrobe", ("armoire", "closet")),
        "washing_machine": CategoryNames(
            "washing machine", ("automatic washer", "laundry machine", "washer")
        ),
        "workbench": CategoryNames("workbench", ()),
        "bicycle": CategoryNames("bicycle", ("bike",)),
        "car": CategoryNames("car", ("automobile", "motorcar")),
    }
)  # fmt: skip
"""Every category that has a name here, by its canonical one; `docs/vocabulary.md` prints it."""


def _normalized(name: str) -> str:
    return "_".join(name.strip().lower().replace("-", " ").replace("_", " ").split())


_CANONICAL = MappingProxyType(
    {_normalized(spelling): name for name, row in VOCABULARY.items() for spelling in row.spellings}
)


def canonical(name: str) -> str:
    """The one spelling of a category name: lower case, underscores, synonyms resolved.

    Free text that is in no table comes back normalised, never rejected.
    """
    key = _normalized(name)
    return _CANONICAL.get(key, key)


def readable(category: str) -> str:
    """The category as prose: `chest_of_drawers` becomes `chest of drawers`."""
    return category.replace("_", " ")


def spoken(category: str) -> str:
    """The category as one says it to an open-vocabulary detector: `fridge` is a refrigerator."""
    row = VOCABULARY.get(canonical(category))
    return readable(category) if row is None else row.spoken
