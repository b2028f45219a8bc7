"""Whether a dataset's numbers agree with each other."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from toponav.categories import HM3D_TARGETS, MP3D_TARGETS, canonical
from toponav.datasets.objectnav import ObjectNavDataset, ObjectNavEpisode
from toponav.datasets.scene_files import Version

DISTANCE_TOLERANCE_M = 1e-3
"""The files give five decimals."""

MAX_TILT = 1e-2
"""A start that leans more than this, radians, is not upright."""


@dataclass(frozen=True)
class DatasetReport:
    """What a dataset holds, and what is wrong with it.

    Attributes:
        version: Which dataset.
        episodes: How many.
        by_scene: Episodes of each scene.
        by_target: Episodes of each target.
        unreachable: Episodes without a path to any viewpoint.
        goals: Distinct goal instances.
        viewpoints: Their viewpoints.
        viewpoint_spacing_m: Median distance between neighbouring viewpoints of an instance.
        problems: One line each; none in a sound file.
    """

    version: str
    episodes: int
    by_scene: dict[str, int]
    by_target: dict[str, int]
    unreachable: int
    goals: int
    viewpoints: int
    viewpoint_spacing_m: float
    problems: tuple[str, ...]


def check_objectnav(dataset: ObjectNavDataset) -> DatasetReport:
    """Look at every episode.

    A stored path cannot be shorter than the straight line to the nearest viewpoint; starts stand
    upright; every target has a viewpoint and a task id, and that id is the benchmark's.
    """
    goals = {id(goal): goal for episode in dataset.episodes for goal in episode.goals}
    spacings = [
        cKDTree(goal.viewpoints).query(goal.viewpoints, k=[2])[0]
        for goal in goals.values()
        if len(goal.viewpoints) > 1
    ]
    problems = [problem for episode in dataset.episodes for problem in _problems(episode)]
    return DatasetReport(
        version=dataset.version.value,
        episodes=len(dataset.episodes),
        by_scene=dict(Counter(episode.scene for episode in dataset.episodes)),
        by_target=dict(sorted(Counter(episode.target for episode in dataset.episodes).items())),
        unreachable=sum(math.isinf(episode.geodesic_distance) for episode in dataset.episodes),
        goals=len(goals),
        viewpoints=sum(len(goal.viewpoints) for goal in goals.values()),
        viewpoint_spacing_m=float(np.median(np.concatenate(spacings))) if spacings else 0.0,
        problems=(*problems, *_wrong_ids(dataset)),
    )


def _problems(episode: ObjectNavEpisode) -> list[str]:
    where = f"{episode.scene} #{episode.index} ({episode.target})"
    problems = []
    if episode.tilt > MAX_TILT:
        problems.append(f"{where}: starts {math.degrees(episode.tilt):.1f} degrees off upright")
    viewpoints = episode.viewpoints
    if not len(viewpoints):
        return [*problems, f"{where}: its goals have no viewpoint"]
    straight = float(np.linalg.norm(viewpoints - episode.start, axis=1).min())
    if episode.geodesic_distance < straight - DISTANCE_TOLERANCE_M:
        problems.append(
            f"{where}: the stored path of {episode.geodesic_distance:.3f} m is shorter than the "
            f"straight line to the nearest viewpoint, {straight:.3f} m"
        )
    return problems


def _wrong_ids(dataset: ObjectNavDataset) -> list[str]:
    """Task ids that are not those of the benchmark."""
    known = MP3D_TARGETS if dataset.version is Version.MP3D_V1 else HM3D_TARGETS
    if dataset.version is Version.OTHER:
        return []
    expected = {name: number for number, name in enumerate(known)}
    return [
        f"{path}: task id of {name} is {number}, the benchmark's is {expected.get(canonical(name))}"
        for path, file in dataset.files.items()
        for name, number in file.category_to_task_category_id.items()
        if expected.get(canonical(name)) != number
    ]
