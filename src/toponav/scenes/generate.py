"""Generated houses: `generated:SEED`, a plan, doors, furniture, stairs and episodes."""

from __future__ import annotations

import re

import numpy as np
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.errors import SceneError
from toponav.scenes.episodes import sample_episodes
from toponav.scenes.floor_plan import FloorPlan, Frame, LevelDrawer, draw_frame
from toponav.scenes.furnish import FurnishConfig, furnish_room
from toponav.scenes.house import House, Level, Stairs
from toponav.scenes.room_space import StairsFootprint, stairs_footprints
from toponav.scenes.validation import validate_house

STOREY_M = 2.8
"""From floor to floor: rooms of 2.6 m and a slab."""
STAIRS_RUN_M = 4.3
"""Horizontal length of a flight: 33 degrees."""
STAIRS_WIDTH_M = 1.0
STAIRS_LANDING_M = 1.1
"""Free floor at the head of a flight."""
STAIRS_FOOT_M = 1.8
"""From the foot to the wall ahead: one passes even where a sofa stands against that wall."""

PRIVATE_ROOMS = (
    "bathroom", "bedroom", "bedroom", "office", "laundry", "bathroom", "bedroom", "closet",
    "kids room", "gym", "garage",
)  # fmt: skip
"""The more rooms, the more of these, in this order."""
UPSTAIRS_ROOMS = (
    "bedroom", "bathroom", "bedroom", "kids room", "closet", "bathroom", "office", "bedroom",
)  # fmt: skip

SPEC = re.compile(r"generated:(\d+)(?:-(\d+))?(?:\?(.*))?")
OPTIONS = ("rooms", "levels", "size", "clutter", "episodes")


class GeneratorConfig(ConfigModel):
    """What kind of houses."""

    rooms: int | None = Field(default=None, ge=3, le=14)
    """Rooms of the ground floor, hallway included; drawn from the seed by default."""

    levels: int | None = Field(default=None, ge=1, le=2)
    """Storeys; by default two of every five seeds (those that end in 3, 4, 8 or 9) have two."""

    size: float = Field(default=1.0, ge=0.6, le=1.6)
    """Stretches all rooms."""

    clutter: float = Field(default=0.5, ge=0.0, le=1.0)
    """How much stands in them beyond the essential."""

    episodes: int = Field(default=2, ge=0, le=1000)
    """Episodes; with two levels every other one starts on a level without the target.

    That one is left out where both levels hold the same targets.
    """


def parse_generator_spec(spec: str) -> list[tuple[int, GeneratorConfig]]:
    """Seeds and options of `generated:SEED` or `generated:FIRST-LAST`, then `?key=value&...`.

    Raises:
        SceneError: One line that says what is wrong with the spec.
    """
    match = SPEC.fullmatch(spec)
    if match is None:
        raise SceneError(
            f"{spec!r} is no generator spec: write generated:SEED or generated:FIRST-LAST, "
            "options after a question mark as in generated:7?rooms=8&levels=2"
        )
    first = int(match[1])
    last = first if match[2] is None else int(match[2])
    if last < first:
        raise SceneError(f"{spec}: the range ends before it starts")
    options: dict[str, str] = {}
    for part in filter(None, (match[3] or "").split("&")):
        key, _, value = part.partition("=")
        if key not in OPTIONS or not value:
            raise SceneError(f"{spec}: unknown option {part!r}; known: {', '.join(OPTIONS)}")
        options[key] = value
    try:
        config = GeneratorConfig.model_validate(options)
    except ValueError as error:
        first_line = str(error).splitlines()
        raise SceneError(f"{spec}: {first_line[1]}: {first_line[2].strip()}") from None
    return [(seed, config) for seed in range(first, last + 1)]


def house_name(seed: int) -> str:
    """Name of the house of a seed."""
    return f"generated_{seed}"


def generate_house(seed: int, config: GeneratorConfig | None = None) -> House:
    """The house of a seed; the same seed and options give the same house."""
    config = config or GeneratorConfig()
    rng = np.random.default_rng([seed, 0x7090])
    levels = config.levels or (2 if seed % 5 in (3, 4) else 1)
    rooms = config.rooms or int(rng.integers(4, 12))
    least = STAIRS_LANDING_M + STAIRS_RUN_M + STAIRS_FOOT_M if levels == 2 else 0.0
    frame = draw_frame(rng, config.size, least)
    plans = [_ground_floor(rng, config.size, frame, rooms)]
    if levels == 2:
        plans.append(_upper_floor(rng, config.size, plans[0]))
    stairs = [_stairs(frame)] if levels == 2 else []
    furnish = FurnishConfig(clutter=config.clutter)
    house = House(
        name=house_name(seed),
        levels=[
            _furnished(plan, STOREY_M * k, rng, furnish, stairs_footprints(stairs, k))
            for k, plan in enumerate(plans)
        ],
        stairs=stairs,
    )
    apart = (False, True) if levels == 2 else (False,)
    episodes = sample_episodes(house, rng, config.episodes, apart)
    house = house.model_copy(update={"episodes": episodes})
    validate_house(house)
    return house


def _ground_floor(rng: np.random.Generator, scale: float, frame: Frame, rooms: int) -> FloorPlan:
    """Public zone by the number of rooms, hallway, and the rest on the hallway.

    With three rooms there is no hallway: the bathroom opens onto the living room.
    """
    public = ["living room", "kitchen"]
    if rooms == 3:
        return LevelDrawer(rng, scale, frame, 0).draw([*public, "bathroom"], ())
    if rooms >= 6 and rng.random() < 0.7:
        public.append("dining room")
    private = PRIVATE_ROOMS[: rooms - len(public) - 1]
    return LevelDrawer(rng, scale, frame, 0).draw(public, private)


def _upper_floor(rng: np.random.Generator, scale: float, below: FloorPlan) -> FloorPlan:
    """A landing over the living room, and bedrooms over what lies below; at least one."""
    public = ["hallway", "office" if rng.random() < 0.5 else "library"]
    if not below.has_hallway:
        public.append("bedroom")
    drawer = LevelDrawer(rng, scale, below.frame, 1)
    return drawer.draw(public, UPSTAIRS_ROOMS, limits=below.row_ends)


def _stairs(frame: Frame) -> Stairs:
    """A flight along the north wall of the living room, up towards the west."""
    y = round(frame.depth - 0.12 - STAIRS_WIDTH_M / 2, 3)
    top = STAIRS_LANDING_M
    return Stairs(
        from_level=0,
        to_level=1,
        start=(round(top + STAIRS_RUN_M, 3), y),
        end=(top, y),
        width=STAIRS_WIDTH_M,
    )


def _furnished(
    plan: FloorPlan,
    floor: float,
    rng: np.random.Generator,
    config: FurnishConfig,
    stairs: list[StairsFootprint],
) -> Level:
    objects = []
    for room in plan.rooms:
        openings = [opening for opening in plan.openings if room.id in opening.rooms]
        objects += furnish_room(room, openings, floor, rng, config, stairs)
    return Level(floor=floor, rooms=list(plan.rooms), openings=list(plan.openings), objects=objects)
