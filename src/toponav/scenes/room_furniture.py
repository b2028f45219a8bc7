"""What each type of room is furnished with: common knowledge, by how likely it is."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Place(Enum):
    """Where in a room a thing goes."""

    WALL = "with its back to a wall"
    CORNER = "near a corner"
    CENTER = "in the middle, with room to walk round it"
    HUNG = "on a wall, above the floor"


@dataclass(frozen=True)
class Wish:
    """A thing that a room should hold.

    Attributes:
        category: Canonical name.
        place: Where it goes.
        chance: Probability that the room has it.
        height_m: Of its base above the floor, for things that hang.
        group: What comes with it: see `furnish`.
    """

    category: str
    place: Place = Place.WALL
    chance: float = 1.0
    height_m: float = 0.0
    group: str = ""


PLANT = Wish("plant", Place.CORNER, 0.35)
PICTURE = Wish("picture", Place.HUNG, 0.6, 1.3)
LAMP = Wish("lamp", Place.CORNER, 0.4)

ROOM_WISHES: dict[str, tuple[Wish, ...]] = {
    "bedroom": (
        Wish("bed", group="nightstands"),
        Wish("wardrobe", chance=0.85),
        Wish("chest_of_drawers", chance=0.5),
        Wish("desk", chance=0.25, group="desk"),
        Wish("chair", chance=0.2),
        Wish("tv_stand", chance=0.12, group="tv"),
        PICTURE,
        Wish("mirror", Place.HUNG, 0.3, 0.9),
        LAMP,
        PLANT,
    ),
    "kids room": (
        Wish("bed"),
        Wish("wardrobe", chance=0.6),
        Wish("desk", chance=0.6, group="desk"),
        Wish("bookshelf", chance=0.5),
        Wish("box", Place.CORNER, 0.6),
        PICTURE,
    ),
    "bathroom": (
        Wish("toilet"),
        Wish("sink"),
        Wish("bathtub", chance=0.5),
        Wish("shower", Place.CORNER, 0.5),
        Wish("mirror", Place.HUNG, 0.7, 1.1),
        Wish("towel", Place.HUNG, 0.8, 0.9),
        Wish("washing_machine", chance=0.15),
        Wish("refuse_bin", Place.CORNER, 0.4),
    ),
    "kitchen": (
        Wish("counter", group="counter"),
        Wish("fridge"),
        Wish("oven"),
        Wish("counter", chance=0.6),
        Wish("dishwasher", chance=0.5),
        Wish("table", Place.CENTER, 0.4, group="dining"),
        Wish("refuse_bin", Place.CORNER, 0.6),
        Wish("stool", chance=0.3),
        Wish("plant", Place.CORNER, 0.15),
    ),
    "living room": (
        Wish("sofa", group="lounge"),
        Wish("tv_stand", group="tv"),
        Wish("bookshelf", chance=0.6),
        Wish("chair", chance=0.4, group="armchair"),
        Wish("cabinet", chance=0.4),
        Wish("fireplace", chance=0.15),
        Wish("piano", chance=0.08),
        PICTURE,
        Wish("picture", Place.HUNG, 0.5, 1.3),
        LAMP,
        Wish("plant", Place.CORNER, 0.7),
    ),
    "dining room": (
        Wish("table", Place.CENTER, group="dining"),
        Wish("cabinet", chance=0.7),
        PICTURE,
        Wish("plant", Place.CORNER, 0.4),
        LAMP,
    ),
    "office": (
        Wish("desk", group="desk"),
        Wish("bookshelf", chance=0.9),
        Wish("cabinet", chance=0.4),
        Wish("chair", chance=0.3, group="armchair"),
        PICTURE,
        PLANT,
        LAMP,
    ),
    "hallway": (
        Wish("shoe_rack", chance=0.3),
        Wish("picture", Place.HUNG, 0.5, 1.3),
        Wish("mirror", Place.HUNG, 0.3, 0.9),
        Wish("plant", Place.CORNER, 0.12),
    ),
    "entryway": (
        Wish("shoe_rack", chance=0.8),
        Wish("bench", chance=0.4),
        Wish("mirror", Place.HUNG, 0.5, 0.9),
    ),
    "laundry": (
        Wish("washing_machine"),
        Wish("dryer", chance=0.7),
        Wish("cabinet", chance=0.5),
        Wish("clothes", chance=0.4),
    ),
    "closet": (Wish("clothes"), Wish("shoe_rack", chance=0.4), Wish("box", Place.CORNER, 0.7)),
    "garage": (
        Wish("car", Place.CENTER, 0.6),
        Wish("workbench", chance=0.8),
        Wish("bicycle", chance=0.6),
        Wish("box", Place.CORNER, 0.8),
        Wish("cabinet", chance=0.5),
    ),
    "gym": (
        Wish("gym_equipment"),
        Wish("gym_equipment", chance=0.6),
        Wish("bench", chance=0.7),
        Wish("mirror", Place.HUNG, 0.8, 0.5),
        Wish("tv_stand", chance=0.2, group="tv"),
    ),
    "utility room": (
        Wish("washing_machine", chance=0.6),
        Wish("cabinet", chance=0.7),
        Wish("box", Place.CORNER, 0.7),
    ),
    "library": (
        Wish("bookshelf"),
        Wish("bookshelf"),
        Wish("chair", group="armchair"),
        Wish("table", Place.CENTER, 0.4),
        LAMP,
    ),
}

UNKNOWN_ROOM_WISHES = (Wish("cabinet", chance=0.5), Wish("chair", chance=0.4), PICTURE, PLANT)

_KEYWORDS = (
    ("bath", "bathroom"), ("toilet", "bathroom"), ("powder", "bathroom"), ("shower", "bathroom"),
    ("wc", "bathroom"), ("kid", "kids room"), ("child", "kids room"), ("nursery", "kids room"),
    ("bed", "bedroom"), ("kitchen", "kitchen"), ("dining", "dining room"),
    ("living", "living room"),
    ("family", "living room"), ("lounge", "living room"), ("tv", "living room"),
    ("office", "office"), ("study", "office"), ("entry", "entryway"), ("foyer", "entryway"),
    ("hall", "hallway"), ("corridor", "hallway"), ("landing", "hallway"), ("laundry", "laundry"),
    ("closet", "closet"), ("wardrobe", "closet"), ("storage", "closet"), ("garage", "garage"),
    ("gym", "gym"), ("workout", "gym"), ("utility", "utility room"), ("librar", "library"),
)  # fmt: skip


def furnished_types(label: str) -> tuple[str, ...]:
    """The room types that a free label stands for, as in "kitchen/living room"; maybe none."""
    text = label.lower().replace("_", " ")
    found = [(text.index(word), kind) for word, kind in _KEYWORDS if word in text]
    return tuple(dict.fromkeys(kind for _, kind in sorted(found)))


def wishes_for(label: str) -> tuple[Wish, ...]:
    """What a room of that label should hold, the most important first."""
    types = furnished_types(label)
    if not types:
        return UNKNOWN_ROOM_WISHES
    return tuple(wish for kind in types for wish in ROOM_WISHES[kind])
