"""Groups: every episode is in exactly one, the same one whichever run it is in."""

from __future__ import annotations

import math
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_results import made_result, made_run
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.tables.groups import UNKNOWN, GroupKind, grouping

KINDS: tuple[GroupKind, ...] = get_args(GroupKind)

results = st.builds(
    made_result,
    scene=st.sampled_from(["a", "b", "c"]),
    target=st.sampled_from(["", "bed", "tv_monitor"]),
    shortest_path=st.one_of(st.floats(0.0, 40.0), st.just(math.inf)),
    scene_m2=st.one_of(st.just(0.0), st.floats(10.0, 400.0)),
    floor_change=st.booleans(),
)


@pytest.mark.parametrize("kind", KINDS)
@given(first=st.lists(results, min_size=1, max_size=8), second=st.lists(results, max_size=8))
@settings(max_examples=30)
def test_groups_are_a_partition_of_every_run(
    kind: GroupKind, first: list[EpisodeResult], second: list[EpisodeResult]
) -> None:
    runs = [made_run("x", first), made_run("y", second)]
    groups = grouping(kind, runs)
    assert len(set(groups.names)) == len(groups.names)
    for run in runs:
        members = [groups.members(run, name) for name in groups.names]
        assert sum(map(len, members)) == len(run.episodes)
        assert all(groups.of(e) == n for n, m in zip(groups.names, members, strict=True) for e in m)
    filled = [any(groups.members(run, name) for run in runs) for name in groups.names]
    assert all(filled)


def names(kind: GroupKind, *episodes: EpisodeResult) -> tuple[list[str], list[str]]:
    """The groups in order, and that of each episode."""
    groups = grouping(kind, [made_run("x", episodes)])
    return list(groups.names), [groups.of(episode) for episode in episodes]


def test_categories_are_read_as_prose_and_the_unknown_comes_last() -> None:
    targets = ["tv_monitor", "", "bed"]
    order, of = names("category", *(made_result(target=target) for target in targets))
    assert order == ["bed", "tv monitor", UNKNOWN]
    assert of == ["tv monitor", UNKNOWN, "bed"]


def test_distances_have_their_lower_edge() -> None:
    paths = [15.0, 4.999, 5.0, 14.9, 10.0, math.inf]
    order, of = names("distance", *(made_result(shortest_path=path) for path in paths))
    assert order == ["0-5 m", "5-10 m", "10-15 m", "15+ m", UNKNOWN]
    assert of == ["15+ m", "0-5 m", "5-10 m", "10-15 m", "10-15 m", UNKNOWN]


def test_sizes_by_fixed_edges() -> None:
    areas = [49.0, 50.0, 250.0, 0.0]
    order, of = names("size-fixed", *(made_result(scene_m2=area) for area in areas))
    assert order == ["0-50 m2", "50-100 m2", "200+ m2", UNKNOWN]
    assert of == ["0-50 m2", "50-100 m2", "200+ m2", UNKNOWN]


def test_sizes_by_thirds_print_their_bounds() -> None:
    order, of = names("size", *(made_result(scene_m2=float(area)) for area in range(10, 100, 10)))
    assert order == ["0-36.7 m2", "36.7-63.3 m2", "63.3+ m2"]
    assert [of.count(name) for name in order] == [3, 3, 3]


def test_thirds_of_one_size_are_one_group() -> None:
    order, _ = names("size", made_result(scene_m2=60.0), made_result(index=1, scene_m2=60.0))
    assert order == ["60.0+ m2"]


def test_floors_come_in_order() -> None:
    order, _ = names("floor", made_result(floor_change=True), made_result(index=1))
    assert order == ["same floor", "other floor"]
