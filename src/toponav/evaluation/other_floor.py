"""Which episodes need a change of floor, told from their scenes before anything runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.errors import InputError
from toponav.evaluation.rollout import FLOOR_CHANGE_M
from toponav.evaluation.sources import Source
from toponav.evaluation.tasks import Task
from toponav.scenes.mesh import Scene, SceneEpisode

Only = Literal["other-floor", "same-floor"]
"""Episodes whose target is on no floor but others than the start's, or the rest."""

STOREY_M = 2.0
"""What stands or hangs this far above the start's floor is still on it."""


def only(tasks: Sequence[Task], source: Source, which: Only) -> list[Task]:
    """Those of the tasks whose episodes need a change of floor, or do not; loads the scenes.

    Args:
        tasks: Of a run, scene by scene.
        source: Where they come from.
        which: Which of them to keep.

    Raises:
        InputError: None is left. Episodes that a scene does not bring, but that are drawn in it,
            cannot be told and are left out.
        SceneError: A scene cannot be loaded.
    """
    kept = []
    spec, scene = "", None
    for task in tasks:
        if task.spec != spec or scene is None:
            spec, scene = task.spec, source.load(task.spec)
        if task.index < len(scene.episodes):
            changes = changes_floor(scene, scene.episodes[task.index])
            if changes is (which == "other-floor"):
                kept.append(task)
    if not kept:
        raise InputError(f"--only {which}: no episode that the scenes bring is one")
    return kept


def changes_floor(scene: Scene, episode: SceneEpisode) -> bool:
    """Whether every instance of the target is on another floor than the start."""
    height = _goal_heights(scene, canonical(episode.target)) - episode.start[2]
    return bool(np.all((height < -FLOOR_CHANGE_M) | (height > STOREY_M)))


def _goal_heights(scene: Scene, target: str) -> NDArray[np.float64]:
    """(N,) heights of the goals' viewpoints where a dataset brings them, else of their bases."""
    if target in scene.viewpoints:
        return scene.viewpoints[target][:, 2]
    mesh = scene.mesh
    lowest = np.full(len(mesh.instances), np.inf)
    np.minimum.at(lowest, mesh.face_instance, mesh.vertices[mesh.faces, 2].min(axis=1))
    wanted = [i.id for i in mesh.instances if canonical(i.category) == target]
    return lowest[wanted]
