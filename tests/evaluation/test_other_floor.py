"""Episodes are told by whether they need a change of floor, as their results tell it."""

from __future__ import annotations

import pytest

from toponav.errors import InputError
from toponav.evaluation.other_floor import changes_floor, only
from toponav.evaluation.rollout import FLOOR_CHANGE_M
from toponav.evaluation.run_config import run_config
from toponav.evaluation.runner import SceneRunner
from toponav.evaluation.sources import SceneSource
from toponav.evaluation.tasks import plan

TWO_LEVELS = SceneSource("generated:200-201?levels=2&rooms=4&size=0.7")


def test_the_two_kinds_together_are_all_episodes() -> None:
    tasks = plan(TWO_LEVELS.outlines(), None)
    other, same = (only(tasks, TWO_LEVELS, which) for which in ("other-floor", "same-floor"))
    assert {task.index for task in other} == {1}
    assert {task.index for task in same} == {0}
    assert sorted(map(str, [*other, *same])) == sorted(map(str, tasks))


def test_it_agrees_with_the_viewpoints_by_which_episodes_are_scored() -> None:
    scene = TWO_LEVELS.load(TWO_LEVELS.outlines()[0].spec)
    oracle = SceneRunner(scene, run_config("default")).env.oracle
    for episode in scene.episodes:
        heights = oracle.viewpoints(episode.target)[:, 2]
        apart = bool((abs(heights - episode.start[2]) > FLOOR_CHANGE_M).all())
        assert changes_floor(scene, episode) is apart


def test_a_source_without_such_an_episode_is_refused() -> None:
    source = SceneSource("generated:0?levels=1")
    with pytest.raises(InputError, match="other-floor"):
        only(plan(source.outlines(), None), source, "other-floor")
