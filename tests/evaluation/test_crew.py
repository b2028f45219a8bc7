"""The driver and its crews: whatever dies, and in whatever order, every task has one outcome."""

from __future__ import annotations

import os
import random
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from small_house import small_config
from toponav.errors import InputError, TopoNavError
from toponav.evaluation.blank_worker import BlankWorker
from toponav.evaluation.crew import MAX_DEATHS, InProcess, Outcome, attempt, drive
from toponav.evaluation.episode_worker import EpisodeWorker
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.run_folder import RunFolder, RunRequest
from toponav.evaluation.sources import SceneSource
from toponav.evaluation.tasks import SceneOutline, Task, TaskQueue, plan

FAILED = BlankWorker().failed
TASKS = plan([SceneOutline(name, name, 4) for name in "abc"], None)


class Mortal:
    """A crew whose workers finish in a random order and die as often as each task is deadly."""

    def __init__(self, size: int, seed: int, deadly: dict[Task, int]) -> None:
        self.size = size
        self._random = random.Random(seed)
        self._deaths_left = dict(deadly)
        self._running: dict[int, Task] = {}
        self.starts = Counter[Task]()

    def start(self, worker: int, task: Task) -> None:
        assert 0 <= worker < self.size
        assert worker not in self._running, "a worker got a second task before it was done"
        self._running[worker] = task
        self.starts[task] += 1

    def wait(self) -> tuple[int, Outcome | None]:
        worker = self._random.choice(sorted(self._running))
        task = self._running.pop(worker)
        if self._deaths_left.get(task, 0):
            self._deaths_left[task] -= 1
            return worker, None
        return worker, Outcome(task, BlankWorker().run(task))

    def close(self) -> None:
        assert not self._running


def driven(crew: Mortal | InProcess) -> list[Outcome]:
    outcomes: list[Outcome] = []
    drive(crew, TaskQueue(TASKS), FAILED, outcomes.append)
    crew.close()
    return outcomes


@given(
    size=st.integers(1, 20),
    seed=st.integers(0, 10_000),
    deadly=st.dictionaries(st.sampled_from(TASKS), st.integers(1, MAX_DEATHS + 2)),
)
def test_every_task_has_one_outcome_however_the_workers_end(
    size: int, seed: int, deadly: dict[Task, int]
) -> None:
    crew = Mortal(size, seed, deadly)
    outcomes = driven(crew)
    assert Counter(outcome.task for outcome in outcomes) == Counter(TASKS)
    for outcome in outcomes:
        deaths = min(deadly.get(outcome.task, 0), MAX_DEATHS)
        given_up = deaths == MAX_DEATHS
        assert crew.starts[outcome.task] == (deaths if given_up else deaths + 1)
        assert outcome.result.key == outcome.task.key
        assert (outcome.result.failure == "error") == given_up
        if given_up:
            assert outcome.result.ended == f"error: its worker died {MAX_DEATHS} times"
            assert not any(outcome.result.success.values())


def test_all_workers_are_kept_busy() -> None:
    class Counting(Mortal):
        """Looks at how many run whenever one is waited for."""

        most = 0

        def wait(self) -> tuple[int, Outcome | None]:
            self.most = max(self.most, len(self._running))
            return super().wait()

    crew = Counting(5, 0, {})
    driven(crew)
    assert crew.most == 5


def test_one_in_this_process_goes_through_the_plan_in_order() -> None:
    outcomes = driven(InProcess(BlankWorker))
    assert [outcome.task for outcome in outcomes] == TASKS


class Clumsy(BlankWorker):
    """A worker with a defect that one task shows."""

    def run(self, task: Task) -> EpisodeResult:
        if task == TASKS[1]:
            raise ZeroDivisionError("no such luck")
        return super().run(task)


def test_a_defect_costs_its_own_episode_and_is_written_down_with_its_traceback(
    tmp_path: Path,
) -> None:
    run = RunFolder(tmp_path)
    with run.opened(RunRequest(source="x"), small_config(), resume=False):
        drive(InProcess(Clumsy), TaskQueue(TASKS), FAILED, run.keep)
    results = run.journal.results()
    assert [result.key for result in results] == [task.key for task in TASKS]
    assert [k for k, result in enumerate(results) if result.failure == "error"] == [1]
    assert results[1].ended == "error: ZeroDivisionError: no such luck"
    log = (tmp_path / "errors.log").read_text()
    assert log.startswith("a #1\nTraceback (most recent call last):")
    assert "ZeroDivisionError: no such luck" in log
    assert "in run" in log


def test_an_interrupt_is_no_defect() -> None:
    class Stopped(BlankWorker):
        """The user presses Ctrl-C."""

        def run(self, task: Task) -> EpisodeResult:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        attempt(Stopped(), TASKS[0])


def test_the_real_worker_gives_the_same_result_in_any_order() -> None:
    worker = EpisodeWorker(SceneSource("generated:6-7"), small_config("random", max_steps=4))
    tasks = plan([SceneOutline(f"generated:{k}", f"generated_{k}", 2) for k in (6, 7)], None)
    forwards = [worker.run(task) for task in tasks]
    backwards = [worker.run(task) for task in reversed(tasks)]
    assert [replace(result, seconds={}) for result in forwards] == [
        replace(result, seconds={}) for result in reversed(backwards)
    ]


def test_a_scene_that_cannot_be_loaded_fails_its_episodes_and_no_others() -> None:
    worker = EpisodeWorker(SceneSource("generated:6"), small_config("random", max_steps=4))
    good = Task("generated:6", "generated_6", 0)
    lost = worker.run(Task("gone.json", "gone", 0))
    assert lost.key == ("gone", 0)
    assert lost.failure == "error"
    assert "gone.json: no such file" in lost.ended
    assert lost.config_sha == worker.run(good).config_sha
    assert worker.run(good).ended == "step-limit"


class Doomed(BlankWorker):
    """Dies of one task, whoever runs it; of another once, leaving a note."""

    def __init__(self, notes: Path) -> None:
        super().__init__()
        self._note = notes / "died"

    def run(self, task: Task) -> EpisodeResult:
        if task == TASKS[2]:
            os._exit(1)
        if task == TASKS[5] and not self._note.exists():
            self._note.touch()
            os._exit(1)
        return super().run(task)


@pytest.fixture
def cluster() -> Iterator[None]:
    ray = pytest.importorskip("ray", reason="needs the extra `ray`")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    # The workers of these tests are no part of the package that the processes can import.
    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    yield
    ray.cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    ray.shutdown()


def test_processes_that_die_are_replaced_and_more_than_the_cluster_has_are_refused(
    cluster: None, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    from toponav.evaluation.distributed import RayCrew

    with pytest.raises(InputError, match="--workers 3: the Ray cluster has 2 CPUs"):
        RayCrew(BlankWorker, size=3)
    with (
        closing(RayCrew(partial(int, "x"), size=1)) as crew,  # type: ignore[arg-type]
        pytest.raises(TopoNavError, match=r"no worker can start \(.*invalid literal"),
    ):
        drive(crew, TaskQueue(TASKS), FAILED, never)
    crew = RayCrew(partial(Doomed, tmp_path), size=2)
    outcomes: list[Outcome] = []
    drive(crew, TaskQueue(TASKS), FAILED, outcomes.append)
    crew.close()
    assert Counter(outcome.task for outcome in outcomes) == Counter(TASKS)
    given_up = [outcome.task for outcome in outcomes if outcome.result.failure == "error"]
    assert given_up == [TASKS[2]]
    assert all(
        outcome.result == BlankWorker().run(outcome.task)
        for outcome in outcomes
        if outcome.task != TASKS[2]
    )
    assert capfd.readouterr().out == ""


def never(outcome: Outcome) -> None:
    raise AssertionError(f"nothing could run, yet there is {outcome}")
