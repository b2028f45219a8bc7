"""The Crew seam: workers that run one task each at a time, and the driver that keeps them busy."""

from __future__ import annotations

import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.tasks import Task, TaskQueue

MAX_DEATHS = 3
"""A task whose worker has died so often is given up: it is what kills them."""


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    Attributes:
        task: The task.
        result: Its result; an episode that raised has one too, which says so.
        trace: Traceback of an error that nobody raised on purpose, else "".
    """

    task: Task
    result: EpisodeResult
    trace: str = ""


class Worker(Protocol):
    """Runs tasks, one after the other; lives in a process of its own or in the driver's."""

    def run(self, task: Task) -> EpisodeResult:
        """Run one episode."""
        ...

    def failed(self, task: Task, reason: str) -> EpisodeResult:
        """The result of an episode that could not be run or not be finished."""
        ...


WorkerFactory = Callable[[], Worker]


class Crew(Protocol):
    """A number of workers. `start` is called only for a worker that has nothing to do.

    Attributes:
        size: How many; they are numbered from 0.
    """

    size: int

    def start(self, worker: int, task: Task) -> None:
        """Let a worker begin a task; returns at once."""
        ...

    def wait(self) -> tuple[int, Outcome | None]:
        """The next worker to finish and its outcome, or None if it died; a new one replaces it."""
        ...

    def close(self) -> None:
        """Let the workers go."""
        ...


class InProcess:
    """A crew of one, in the driver's own process."""

    size = 1

    def __init__(self, make_worker: WorkerFactory) -> None:
        """Make the worker."""
        self._worker = make_worker()
        self._task: Task | None = None

    def start(self, worker: int, task: Task) -> None:
        """Remember the task; `wait` runs it."""
        assert worker == 0
        self._task = task

    def wait(self) -> tuple[int, Outcome | None]:
        """Run the task."""
        assert self._task is not None
        return 0, attempt(self._worker, self._task)

    def close(self) -> None:
        """Nothing is held."""


def attempt(worker: Worker, task: Task) -> Outcome:
    """Run a task; an error that nobody expected is its result, for the run goes on without it."""
    try:
        return Outcome(task, worker.run(task))
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        return Outcome(task, worker.failed(task, reason), traceback.format_exc())


def drive(
    crew: Crew, queue: TaskQueue, failed: Callable[[Task, str], EpisodeResult],
    on_outcome: Callable[[Outcome], None],
) -> None:  # fmt: skip
    """Keep the crew busy until the queue is empty, and hand on every outcome as it comes.

    A worker holds one task at a time, so a death costs one episode in flight, which is run again,
    and results never pile up.

    Args:
        crew: The workers.
        queue: The tasks.
        failed: Makes the result of a task that was given up.
        on_outcome: Called with each outcome, once a task.
    """
    idle, busy = set(range(crew.size)), dict[int, Task]()
    deaths = Counter[Task]()
    while True:
        for worker in sorted(idle):
            task = queue.take(worker)
            if task is not None:
                crew.start(worker, task)
                busy[worker] = task
                idle.remove(worker)
        if not busy:
            return
        worker, outcome = crew.wait()
        task = busy.pop(worker)
        idle.add(worker)
        if outcome is not None:
            on_outcome(outcome)
            continue
        deaths[task] += 1
        if deaths[task] < MAX_DEATHS:
            queue.give_back(task)
        else:
            reason = f"its worker died {MAX_DEATHS} times"
            on_outcome(Outcome(task, failed(task, reason)))
