"""Our metrics against habitat-lab's definitions, restated here step by step.

habitat-lab's measures are updated after every step: DistanceToGoal asks the path finder, SPL adds
the Euclidean length of the step, and both end up in the formulas of `nav.py`. The reference below
does the same with a distance function of its own, so that a recorded trajectory is scored twice.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from shared_data import shared_data
from toponav.datasets import ObjectNavEpisode, load_objectnav
from toponav.evaluation.results import Score, score_episode

Point = tuple[float, float, float]
Distance = Callable[[Point], float]

RADIUS = 0.1


class HabitatMeasures:
    """DistanceToGoal, Success, SPL and SoftSPL of one episode, updated step by step."""

    def __init__(self, distance: Distance, start: Point) -> None:
        self._distance = distance
        self._previous = start
        self._start_distance = distance(start)
        self._walked = 0.0
        self.distance_to_goal = self._start_distance
        self.success = self.spl = self.soft_spl = 0.0

    def update(self, position: Point, stop_called: bool) -> None:
        if self._previous != position:
            self.distance_to_goal = self._distance(position)
        self._walked += float(np.linalg.norm(np.subtract(position, self._previous)))
        self._previous = position
        self.success = float(stop_called and self.distance_to_goal < RADIUS)
        with np.errstate(invalid="ignore", divide="ignore"):
            start = np.float64(self._start_distance)
            efficiency = start / max(start, self._walked)
            self.spl = float(self.success * efficiency)
            self.soft_spl = float(max(0, 1 - self.distance_to_goal / start) * efficiency)


def both(distance: Distance, walk: Sequence[Point], stops: bool) -> tuple[HabitatMeasures, Score]:
    """A walk scored by habitat-lab's way and by ours."""
    reference = HabitatMeasures(distance, walk[0])
    for position in walk[1:]:
        reference.update(position, False)
    reference.update(walk[-1], stops)
    steps = np.linalg.norm(np.diff(np.array(walk), axis=0), axis=1)
    score = score_episode(stops, distance(walk[-1]), distance(walk[0]), math.fsum(steps))
    return reference, score


def agree(reference: HabitatMeasures, score: Score) -> None:
    assert score.success[str(RADIUS)] == bool(reference.success)
    assert score.spl == pytest.approx(reference.spl, abs=1e-9)
    assert score.soft_spl == pytest.approx(reference.soft_spl, abs=1e-9)


coordinates = st.floats(-20.0, 20.0).map(lambda value: round(value, 3))
points = st.tuples(coordinates, coordinates, st.sampled_from([0.0, 0.2, 3.0]))


@given(walk=st.lists(points, min_size=1, max_size=30), goal=points, stops=st.booleans())
def test_random_walks_score_the_same(walk: list[Point], goal: Point, stops: bool) -> None:
    if math.dist(walk[0], goal) > 0.0:  # l = 0 is below
        agree(*both(lambda point: math.dist(point, goal), walk, stops))


@given(goal=points, start=points, share=st.floats(0.0, 1.0))
def test_walks_that_end_near_the_goal_score_the_same(
    goal: Point, start: Point, share: float
) -> None:
    """Random walks seldom succeed; these end within 0.2 m of the goal."""
    end = (goal[0] + 0.2 * share, goal[1], goal[2])
    if math.dist(start, goal) > 0.0:
        agree(*both(lambda point: math.dist(point, goal), [start, end], True))


def test_the_radius_is_strict() -> None:
    distances = {0.0: 5.0, 1.0: RADIUS, 2.0: math.nextafter(RADIUS, 0.0)}
    for end, expected in ((1.0, False), (2.0, True)):
        reference, score = both(
            lambda point: distances[point[0]], [(0.0, 0.0, 0.0), (end, 0.0, 0.0)], True
        )
        agree(reference, score)
        assert score.success[str(RADIUS)] is expected


def test_a_goal_that_becomes_unreachable_is_a_failure_in_both() -> None:
    reference, score = both(
        lambda point: math.inf if point[0] else 4.0, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], True
    )
    agree(reference, score)
    assert math.isinf(reference.distance_to_goal)
    assert (score.spl, score.soft_spl) == (0.0, 0.0)


def test_without_any_path_habitat_has_no_number_and_we_count_nothing() -> None:
    reference, score = both(lambda point: math.inf, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], True)
    assert math.isnan(reference.spl)  # inf / inf
    assert (score.spl, score.soft_spl, score.success[str(RADIUS)]) == (0.0, 0.0, False)


def test_a_start_at_the_goal_divides_by_zero_there_and_counts_one_here() -> None:
    here = (1.0, 2.0, 0.0)
    reference, score = both(lambda point: math.dist(point, here), [here], True)
    assert reference.success == 1.0
    assert math.isnan(reference.spl)  # 0 / 0
    assert (score.spl, score.soft_spl) == (1.0, 1.0)


@pytest.mark.parametrize("which", ["hm3d/v1", "hm3d/v2", "mp3d/v1"])
def test_walks_in_published_episodes_score_the_same(which: str) -> None:
    """From every published start, straight to its nearest viewpoint, half way, and back."""
    dataset = load_objectnav(shared_data(f"objectnav/{which}/val_mini/val_mini.json.gz"))
    assert len(dataset.episodes) == 30
    for one in dataset.episodes:
        distance, nearest = straight_distance(one)
        there = list(zip(*np.linspace(one.start, nearest, 20).T.tolist(), strict=True))
        arrived, score = both(distance, there, True)
        agree(arrived, score)
        assert score.spl == pytest.approx(1.0)
        for walk in (there[:10], [*there, *there[::-1]]):
            agree(*both(distance, walk, True))


def straight_distance(one: ObjectNavEpisode) -> tuple[Distance, Point]:
    """Distance to the nearest viewpoint, straight through the walls, and that viewpoint."""
    viewpoints = one.viewpoints
    offsets = np.linalg.norm(viewpoints - one.start, axis=1)
    x, y, z = (float(v) for v in viewpoints[offsets.argmin()])
    return lambda p: float(np.linalg.norm(viewpoints - p, axis=1).min()), (x, y, z)
