"""ObjectNav datasets in this project's frame: z up, metres, yaw counter-clockwise from +x.

The conversion from Habitat's frame (y up, -z forward) happens here and nowhere else.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.datasets.objectnav_file import (
    FileEpisode,
    FileGoal,
    ObjectNavFile,
    read_file,
    write_file,
)
from toponav.datasets.scene_files import Version, scene_name, version_of
from toponav.errors import InputError
from toponav.geometry import Pose
from toponav.geometry.conventions import WORLD_FROM_HABITAT

CONTENT = "content"
"""Folder beside a split's file that holds one file a scene."""

HABITAT_FORWARD = (0.0, 0.0, -1.0)


@dataclass(frozen=True, eq=False)
class Goal:
    """One instance of a goal category.

    Attributes:
        object_id: The dataset's own.
        name: The dataset's own, "" without one.
        position: (3,) centre, metres.
        viewpoints: (V, 3) foot points from which it counts as found, metres.
    """

    object_id: int | str
    name: str
    position: NDArray[np.float64]
    viewpoints: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ObjectNavEpisode:
    """One episode; (scene, index) is its key, for Habitat renumbers `episode_id`.

    Attributes:
        scene: The scene's name.
        index: 0-based among the episodes of the scene, in the file's order.
        scene_id: The scene's path, as in the file.
        episode_id: As in the file.
        target: Canonical category.
        start: (x, y, z) foot point, metres.
        yaw: Heading, radians.
        tilt: Angle by which the start's up axis is off the vertical, radians; 0 in sound files.
        geodesic_distance: To the nearest viewpoint, as in the file, metres; may be infinite.
        euclidean_distance: As in the file, metres.
        goals: Every instance of the target in the scene; shared by the episodes that look for it.
    """

    scene: str
    index: int
    scene_id: str
    episode_id: str
    target: str
    start: tuple[float, float, float]
    yaw: float
    tilt: float
    geodesic_distance: float
    euclidean_distance: float
    goals: tuple[Goal, ...]

    @property
    def viewpoints(self) -> NDArray[np.float64]:
        """(N, 3) viewpoints of all goals, metres."""
        return np.concatenate([goal.viewpoints for goal in self.goals] or [np.zeros((0, 3))])


@dataclass(frozen=True, eq=False)
class ObjectNavDataset:
    """Episodes of one split.

    Attributes:
        version: Which of the published datasets it is.
        episodes: In the order of the files, those of a scene together.
        files: What was read, by path relative to the folder of the split's file.
    """

    version: Version
    episodes: tuple[ObjectNavEpisode, ...]
    files: Mapping[PurePosixPath, ObjectNavFile]


def load_objectnav(path: Path) -> ObjectNavDataset:
    """Read a split's file, with the files of its scenes where it has none itself, or one scene's.

    Raises:
        InputError: A file is missing, damaged, breaks the format or holds no episode; or an
            episode's goals are missing. One line that names file, episode and key.
    """
    files = {PurePosixPath(path.name): read_file(path)}
    if not files[PurePosixPath(path.name)].episodes:
        parts = sorted(part for part in (path.parent / CONTENT).glob("*.json*") if part.is_file())
        if not parts:
            raise InputError(
                f"{path}: holds no episodes, and there are none in {path.parent / CONTENT}; keep "
                f"the folder {CONTENT!r} beside the split's file"
            )
        files |= {PurePosixPath(CONTENT, part.name): read_file(part) for part in parts}
    episodes: list[ObjectNavEpisode] = []
    numbers = Counter[str]()
    for name, file in files.items():
        episodes += _episodes(file, path.parent / name, numbers)
    if not episodes:
        raise InputError(f"{path}: holds no episodes")
    return ObjectNavDataset(version_of(episodes[0].scene_id), tuple(episodes), files)


def save_objectnav(dataset: ObjectNavDataset, folder: Path) -> None:
    """Write a dataset's files into a folder, laid out as they were read."""
    for name, file in dataset.files.items():
        write_file(folder / name, file)


def _episodes(file: ObjectNavFile, path: Path, numbers: Counter[str]) -> list[ObjectNavEpisode]:
    """The episodes of one file; `numbers` counts those of each scene so far."""
    goals: dict[str, tuple[Goal, ...]] = {}
    episodes = []
    for place, episode in enumerate(file.episodes):
        key = f"{PurePosixPath(episode.scene_id).name}_{episode.object_category}"
        if key not in goals:
            if key not in file.goals_by_category:
                raise InputError(
                    f"{path}: episodes[{place}]: its goals {key!r} are not in goals_by_category"
                )
            goals[key] = tuple(_goal(goal) for goal in file.goals_by_category[key])
        scene = scene_name(episode.scene_id)
        episodes.append(
            _converted(episode, numbers[scene], goals[key], f"{path}: episodes[{place}]")
        )
        numbers[scene] += 1
    return episodes


def _converted(
    episode: FileEpisode, index: int, goals: tuple[Goal, ...], where: str
) -> ObjectNavEpisode:
    if not np.linalg.norm(episode.start_rotation) > 0.5:
        raise InputError(f"{where}: start_rotation {episode.start_rotation} is no quaternion")
    if math.isnan(episode.info.geodesic_distance):
        raise InputError(f"{where}: info.geodesic_distance is not a number")
    pose = Pose.from_quaternion(episode.start_rotation, episode.start_position)
    x, y, z = (float(v) for v in WORLD_FROM_HABITAT.apply(pose.translation))
    forward = WORLD_FROM_HABITAT.apply(pose.rotation @ np.array(HABITAT_FORWARD))
    upward = float(np.clip(pose.rotation[1, 1], -1.0, 1.0))
    return ObjectNavEpisode(
        scene=scene_name(episode.scene_id),
        index=index,
        scene_id=episode.scene_id,
        episode_id=str(episode.episode_id),
        target=canonical(episode.object_category),
        start=(x, y, z),
        yaw=math.atan2(forward[1], forward[0]),
        tilt=math.acos(upward),
        geodesic_distance=episode.info.geodesic_distance,
        euclidean_distance=episode.info.euclidean_distance,
        goals=goals,
    )


def _goal(goal: FileGoal) -> Goal:
    feet = np.array([point.agent_state.position for point in goal.view_points]).reshape(-1, 3)
    return Goal(
        object_id=goal.object_id,
        name=goal.object_name or "",
        position=WORLD_FROM_HABITAT.apply(goal.position),
        viewpoints=WORLD_FROM_HABITAT.apply(feet),
    )
