"""Furniture and episodes for an imported home that has none."""

from __future__ import annotations

from collections.abc import Collection
from zlib import crc32

import numpy as np

from toponav.scenes.episodes import sample_episodes
from toponav.scenes.furnish import furnish_room
from toponav.scenes.house import House, HouseObject
from toponav.scenes.room_space import stairs_footprints

EPISODES_PER_HOME = 2
"""Episodes of a home that brings none."""


def furnished(house: House, seed: int, bare_types: Collection[str] = ()) -> House:
    """The same house with furniture by room type, and with episodes.

    Args:
        house: A house without furniture.
        seed: The same name and seed give the same furniture.
        bare_types: Room types that stay empty.
    """
    levels = []
    for index, level in enumerate(house.levels):
        stairs = stairs_footprints(house.stairs, index)
        objects: list[HouseObject] = []
        for number, room in enumerate(level.rooms):
            if room.type not in bare_types:
                openings = [opening for opening in level.openings if room.id in opening.rooms]
                rng = np.random.default_rng([_name_seed(house), seed, index, number])
                objects += furnish_room(room, openings, level.floor, rng, stairs=stairs)
        levels.append(level.model_copy(update={"objects": objects}))
    return with_episodes(house.model_copy(update={"levels": levels}), seed)


def with_episodes(house: House, seed: int) -> House:
    """The same house with episodes, each on the level of its target."""
    rng = np.random.default_rng([_name_seed(house), seed])
    episodes = sample_episodes(house, rng, EPISODES_PER_HOME)
    return house.model_copy(update={"episodes": episodes})


def _name_seed(house: House) -> int:
    """A seed from the name that is the same in every process, as `hash` is not."""
    return crc32(house.name.encode())
