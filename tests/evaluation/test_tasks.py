"""Which episodes there are, which part of them a shard is, and who gets which next."""

from __future__ import annotations

import random
from collections import Counter
from itertools import chain, groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import InputError
from toponav.evaluation.tasks import SceneOutline, Task, TaskQueue, plan, shard


def outlines(*episodes: int) -> list[SceneOutline]:
    return [SceneOutline(f"{k}.json", f"s{k}", count) for k, count in enumerate(episodes)]


def counts(tasks: list[Task]) -> list[int]:
    return [len(list(group)) for _, group in groupby(tasks, lambda task: task.scene)]


scene_lists = st.lists(st.integers(0, 5), min_size=1, max_size=8).map(lambda n: outlines(*n))
task_lists = st.lists(st.integers(1, 6), min_size=1, max_size=6).map(
    lambda n: plan(outlines(*n), None)
)


def test_a_plan_goes_scene_by_scene_and_counts_within_each() -> None:
    assert plan(outlines(2, 1), None) == [
        Task("0.json", "s0", 0), Task("0.json", "s0", 1), Task("1.json", "s1", 0),
    ]  # fmt: skip
    assert plan(outlines(2), 1)[0].key == ("s0", 0)


def test_a_scene_that_brings_no_episode_is_searched_once() -> None:
    assert counts(plan(outlines(0, 3, 0), None)) == [1, 3, 1]


@given(scenes=scene_lists, total=st.integers(1, 40))
def test_a_total_is_met_and_spread_evenly(scenes: list[SceneOutline], total: int) -> None:
    tasks = plan(scenes, total)
    assert len(tasks) == total == len({task.key for task in tasks})
    shares = [sum(task.scene == scene.name for task in tasks) for scene in scenes]
    assert max(shares) - min(shares) <= 1
    assert shares == sorted(shares, reverse=True)  # the remainder goes to the first


def test_what_cannot_be_planned_is_said() -> None:
    with pytest.raises(InputError, match="--episodes takes a positive number, not 0"):
        plan(outlines(1), 0)
    twins = [SceneOutline("a/x.json", "x", 1), SceneOutline("b/x.json", "x", 1)]
    with pytest.raises(InputError, match="two scenes are called 'x'"):
        plan(twins, None)


@given(tasks=task_lists, n=st.integers(1, 12))
def test_shards_are_a_partition_into_neighbours_of_nearly_the_same_size(
    tasks: list[Task], n: int
) -> None:
    parts = [shard(tasks, f"{i}/{n}") for i in range(1, n + 1)]
    assert list(chain.from_iterable(parts)) == tasks
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize(
    "text", ["", "1", "/", "0/2", "3/2", "1/0", "-1/2", "1/2/3", "a/b", "1.0/2", " 1/2", "²/3"]
)
def test_what_is_no_shard_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--shard takes i/n"):
        shard(plan(outlines(3), None), text)


@given(tasks=task_lists, workers=st.integers(1, 5), seed=st.integers(0, 1000))
def test_every_task_is_handed_out_once_also_those_given_back(
    tasks: list[Task], workers: int, seed: int
) -> None:
    draw, queue = random.Random(seed), TaskQueue(tasks)
    finished, mercy = Counter[Task](), 2 * len(tasks)
    while (task := queue.take(draw.randrange(workers))) is not None:
        if mercy and draw.random() < 0.3:
            mercy -= 1
            queue.give_back(task)
        else:
            finished[task] += 1
        assert len(queue) == len(tasks) - finished.total()
    assert finished == Counter(tasks)


@given(tasks=task_lists, workers=st.integers(1, 5), seed=st.integers(0, 1000))
def test_a_worker_leaves_its_scene_when_it_is_done_and_shares_one_only_if_it_must(
    tasks: list[Task], workers: int, seed: int
) -> None:
    draw, queue = random.Random(seed), TaskQueue(tasks)
    left = Counter(task.scene for task in tasks)
    scene_of: dict[int, str] = {}
    while left.total():
        worker = draw.randrange(workers)
        own = scene_of.get(worker)
        task = queue.take(worker)
        assert task is not None
        others = {scene for k, scene in scene_of.items() if k != worker}
        if own is not None and left[own]:
            assert task.scene == own
        elif any(left[scene] and scene not in others for scene in left):
            assert task.scene not in others
        else:
            assert left[task.scene] == max(left.values())
        left[task.scene] -= 1
        scene_of[worker] = task.scene


@given(tasks=task_lists)
def test_one_worker_runs_the_plan_as_it_stands(tasks: list[Task]) -> None:
    queue = TaskQueue(tasks)
    assert [queue.take(0) for _ in tasks] == tasks
    assert queue.take(0) is None


def test_a_task_that_is_given_back_comes_first() -> None:
    tasks = plan(outlines(3), None)
    queue = TaskQueue(tasks)
    first = queue.take(0)
    assert first is not None
    queue.give_back(first)
    assert [queue.take(1), queue.take(1)] == tasks[:2]
