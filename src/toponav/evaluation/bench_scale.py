"""What thousands of episodes and many workers cost beside the episodes themselves.

The real driver runs them: task queue, crew, deaths, journal, progress. Only the episodes are blank.
"""

from __future__ import annotations

import json
import math
import random
import time
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.evaluation.blank_worker import BlankWorker
from toponav.evaluation.crew import Crew, Outcome, WorkerFactory, attempt
from toponav.evaluation.evaluate import OnProgress, RunProgress, run_tasks
from toponav.evaluation.funnel import ERROR
from toponav.evaluation.journal import EPISODES_FILE
from toponav.evaluation.process_memory import resident_mb
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import RunFolder, RunRequest
from toponav.evaluation.tasks import SceneOutline, Task, plan

SCENES = 20
"""As many as HM3D's first validation split has."""


class ScaleConfig(ConfigModel):
    """How large a run is feigned."""

    episodes: int = Field(default=2000, ge=1)
    """Episodes; HM3D's first validation split has 2000."""

    workers: int = Field(default=64, ge=1)
    """Workers."""

    deaths: float = Field(default=0.05, ge=0.0, lt=1.0)
    """Share of the runs in which the worker dies."""

    ray: bool = False
    """Workers are real processes that really die; otherwise they are feigned in this one."""


class FeignedCrew:
    """Workers of no substance that finish, or die, in a random order drawn from a seed."""

    def __init__(self, make_worker: WorkerFactory, size: int, deaths: float, seed: int) -> None:
        """Make one worker, which plays them all; `deaths` is the share of runs that one dies in."""
        self.size = size
        self._worker = make_worker()
        self._deaths = deaths
        self._random = random.Random(seed)
        self._running: list[tuple[int, Task]] = []

    def start(self, worker: int, task: Task) -> None:
        """Remember the task."""
        self._running.append((worker, task))

    def wait(self) -> tuple[int, Outcome | None]:
        """Any of those that run finishes or dies."""
        worker, task = self._running.pop(self._random.randrange(len(self._running)))
        died = self._random.random() < self._deaths
        return worker, None if died else attempt(self._worker, task)

    def close(self) -> None:
        """Nothing is held."""


class _Coroner:
    """A crew whose deaths are counted."""

    def __init__(self, crew: Crew) -> None:
        self._crew = crew
        self.size = crew.size
        self.deaths = 0

    def start(self, worker: int, task: Task) -> None:
        self._crew.start(worker, task)

    def wait(self) -> tuple[int, Outcome | None]:
        worker, outcome = self._crew.wait()
        self.deaths += outcome is None
        return worker, outcome

    def close(self) -> None:
        self._crew.close()


def bench_scale(
    config: ScaleConfig, folder: Path, on_progress: OnProgress, seed: int = 0
) -> dict[str, Any]:
    """Drive blank episodes and take stock of what is on the disk afterwards.

    Args:
        config: How many.
        folder: Gets the run's files; holds none yet.
        on_progress: Told of every episode, as by `evaluate`.
        seed: Draws the order in which feigned workers finish and die.

    Returns:
        `episodes_per_s` of bookkeeping, `seconds` in all (with Ray, starting and replacing the
        processes included), workers that `died`, episodes `given_up` for that, `rss_growth_mb`
        of this process at its peak (None where the system does not tell), `journal_kb`, and
        episodes that are `lost` or there more than once, `duplicates`; and the configuration.

    Raises:
        InputError: The folder holds a run; Ray is not installed.
    """
    scenes = [SceneOutline(f"scene_{k:02d}", f"scene_{k:02d}", 0) for k in range(SCENES)]
    tasks = plan(scenes, config.episodes)
    request = RunRequest(source="bench scale", episodes=config.episodes, workers=config.workers)
    run = RunFolder(folder)
    memory = _PeakMemory()

    def watch(progress: RunProgress) -> None:
        on_progress(progress)
        memory.sample()

    started = time.perf_counter()
    with run.opened(request, RunConfig(method="blank"), resume=False):
        crew = _Coroner(_crew(config, seed))
        results = run_tasks(run, tasks, BlankWorker, lambda: crew, watch)
    seconds = time.perf_counter() - started
    return {
        **config.model_dump(),
        "seconds": seconds,
        "episodes_per_s": len(results) / seconds,
        "died": crew.deaths,
        "given_up": sum(result.failure == ERROR for result in results),
        "rss_growth_mb": memory.growth_mb,
        **_stock(folder, tasks),
    }


def _crew(config: ScaleConfig, seed: int) -> Crew:
    if not config.ray:
        return FeignedCrew(BlankWorker, config.workers, config.deaths, seed)
    from toponav.evaluation.distributed import RayCrew

    return RayCrew(partial(BlankWorker, config.deaths), config.workers)


def _stock(folder: Path, tasks: list[Task]) -> dict[str, Any]:
    """What the journal really holds, read without the code that wrote it."""
    path = folder / EPISODES_FILE
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    found = Counter((line["scene"], line["index"]) for line in lines)
    return {
        "journal_kb": path.stat().st_size / 1e3,
        "duplicates": found.total() - len(found),
        "lost": len({task.key for task in tasks} - found.keys()),
    }


class _PeakMemory:
    """How much more memory this process holds than at first, at its peak."""

    def __init__(self) -> None:
        self._first = self._peak = resident_mb()

    def sample(self) -> None:
        self._peak = max(self._peak, resident_mb())

    @property
    def growth_mb(self) -> float | None:
        return None if math.isnan(self._first) else self._peak - self._first
