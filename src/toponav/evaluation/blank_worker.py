"""A worker that runs nothing: it stands for the real one where only the bookkeeping matters."""

from __future__ import annotations

import os
import random
import zlib

from toponav.evaluation.funnel import ERROR, NEVER_VISIBLE, SearchTrace
from toponav.evaluation.results import EpisodeResult, score_episode
from toponav.evaluation.tasks import Task

DEATH_CODE = 1
"""Exit code of a process that dies on purpose."""


class BlankWorker:
    """Makes up results, of the size of real ones; the same task has the same result."""

    def __init__(self, deaths: float = 0.0) -> None:
        """Make it mortal.

        Args:
            deaths: Share of the runs that end the worker's whole process; only for a worker that
                has a process of its own.
        """
        self._deaths = deaths
        self._fate = random.Random()  # no two processes die at the same runs

    def run(self, task: Task) -> EpisodeResult:
        """Make up an episode that walked until the step limit, or die."""
        if self._fate.random() < self._deaths:
            os._exit(DEATH_CODE)
        draw = random.Random(zlib.crc32(f"{task.scene}#{task.index}".encode()))
        return _made_up(task, shortest_path=draw.uniform(1.0, 20.0), walked=draw.uniform(1.0, 60.0))

    def failed(self, task: Task, reason: str) -> EpisodeResult:
        """The result of an episode that was given up."""
        return _made_up(task, shortest_path=1.0, walked=0.0, reason=reason)


def _made_up(task: Task, shortest_path: float, walked: float, reason: str = "") -> EpisodeResult:
    score = score_episode(False, shortest_path, shortest_path, walked)
    return EpisodeResult(
        scene=task.scene,
        index=task.index,
        target="chair",
        method="blank",
        seed=task.index,
        stop_called=False,
        distance_to_goal=shortest_path,
        shortest_path=shortest_path,
        path_length=walked,
        success=score.success,
        spl=score.spl,
        soft_spl=score.soft_spl,
        steps=500,
        collisions=0,
        decisions=0,
        seconds={"simulation": 0.0, "agent": 0.0, "total": 0.0},
        ended=f"error: {reason}" if reason else "step-limit",
        floor_change=False,
        config_sha="0" * 12,
        failure=ERROR if reason else NEVER_VISIBLE,
        search=SearchTrace(closest_m=shortest_path),
    )
