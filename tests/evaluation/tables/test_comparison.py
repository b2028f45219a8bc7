"""Two runs on the same episodes: which are the same, and what differs."""

from __future__ import annotations

import math

import pytest

from made_results import made_result, made_run, missed
from toponav.evaluation.statistics import Resampling
from toponav.evaluation.tables.comparison import common_episodes, compare

QUICK = Resampling(resamples=200)


def test_differences_by_hand() -> None:
    run = made_run("run", [
        made_result(index=0, steps=20),
        made_result(index=1, steps=40),
        missed(index=2, steps=500),
        made_result(index=3, steps=10),
    ])  # fmt: skip
    base = made_run("base", [
        made_result(index=0, steps=30),
        missed(index=1, steps=500),
        missed(index=2, steps=500),
        made_result(index=9, steps=10),
    ])  # fmt: skip
    found = compare(run, base, QUICK)
    assert (found.common, found.elsewhere) == (3, 0)
    assert (found.outcomes.first_only, found.outcomes.second_only) == (1, 0)
    assert found.success.value == pytest.approx(1 / 3)
    assert found.means["steps"].value == pytest.approx((-10 - 460 + 0) / 3)
    assert found.means["spl"].value == pytest.approx(0.8 / 3)
    assert found.means["dtg"].value == pytest.approx((0.0 - 1.95 + 0.0) / 3)
    assert found.note == ""


def test_a_run_does_not_differ_from_itself() -> None:
    run = made_run("run", [made_result(index=0), missed(index=1), made_result(index=2)])
    found = compare(run, run, QUICK)
    assert found.success.value == 0.0
    assert found.outcomes.p_value == 1.0
    assert all(mean.value == 0.0 and mean.interval == (0.0, 0.0) for mean in found.means.values())


def test_changing_places_changes_the_signs() -> None:
    run = made_run("run", [made_result(index=k, steps=20 + k) for k in range(6)])
    base = made_run("base", [missed(index=k, steps=300 - k * k) for k in range(6)])
    there, back = compare(run, base, QUICK), compare(base, run, QUICK)
    assert there.success.value == -(back.success.value or 0.0) == 1.0
    for key, mean in there.means.items():
        assert mean.value == pytest.approx(-(back.means[key].value or 0.0))
    assert there.outcomes.p_value == back.outcomes.p_value == pytest.approx(2 / 64)


def test_no_common_episode_is_no_difference() -> None:
    found = compare(made_run("a", [made_result()]), made_run("b", [made_result("t")]), QUICK)
    assert found.common == 0
    assert found.success.value is None
    assert all(mean.value is None and mean.interval is None for mean in found.means.values())


def test_an_infinite_distance_in_either_run_is_no_difference_in_distance() -> None:
    lost = {"distance_to_goal": math.inf}
    run = made_run("a", [made_result(index=0), missed(index=1, **lost), missed(index=2, **lost)])
    base = made_run("b", [missed(index=0), missed(index=1), missed(index=2, **lost)])
    distance = compare(run, base, QUICK).means["dtg"]
    assert (distance.value, distance.n) == (pytest.approx(-1.95), 1)


@pytest.mark.parametrize(
    "other", [{"shortest_path": 4.1}, {"target": "sofa"}, {"shortest_path": math.inf}]
)
def test_another_start_or_target_is_another_episode(other: dict[str, object]) -> None:
    run = made_run("a", [made_result(index=0), made_result(index=1)])
    base = made_run("b", [made_result(index=0), made_result(index=1, **other)])
    pairs, elsewhere = common_episodes(run, base)
    assert [(own.index, theirs.index) for own, theirs in pairs] == [(0, 0)]
    assert elsewhere == 1


def test_another_seed_does_not_make_another_episode_of_the_same_start() -> None:
    pairs, _ = common_episodes(made_run("a", [made_result(seed=1)]), made_run("b", [made_result()]))
    assert len(pairs) == 1


def test_an_episode_that_crashed_counts_against_the_run_that_crashed() -> None:
    crash = missed(target="", shortest_path=math.inf, distance_to_goal=math.inf, failure="error",
                   ended="error: lost", path_length=0.0, steps=0)  # fmt: skip
    found = compare(made_run("a", [crash]), made_run("b", [made_result()]), QUICK)
    assert (found.common, found.outcomes.second_only) == (1, 1)


def test_scenes_are_resampled_whole_on_request() -> None:
    run = made_run("a", [made_result(scene, k) for scene in "abc" for k in range(5)])
    base = made_run(
        "b",
        [(made_result if scene == "a" else missed)(scene, k) for scene in "abc" for k in range(5)],
    )
    clustered = compare(run, base, Resampling(resamples=5_000, unit="scene"))
    plain = compare(run, base, Resampling(resamples=500))
    assert clustered.success.value == plain.success.value == pytest.approx(10 / 15)
    assert clustered.success.interval == (0.0, 1.0)
    assert plain.success.interval is not None
    assert plain.success.interval[0] > 0.2
