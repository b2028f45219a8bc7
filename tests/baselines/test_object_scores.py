"""Labelled cells against hand-made images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawn_map import detections_of, observation_at
from toponav.baselines.object_scores import CELL_M, ObjectScores
from toponav.mapping.semantic_map import MapConfig

MIDDLE = (18, 13, 22, 17)
"""A box about the optical axis: what stands 2 m ahead of the agent."""


def scores_of(*frames: tuple[float, float, str, float]) -> ObjectScores:
    """Objects seen 2 m ahead of (x, y), each with its label and score."""
    scores = ObjectScores(MapConfig())
    for x, y, label, score in frames:
        scores.add(observation_at(x, y), detections_of({label: MIDDLE}, [score]), floor=0)
    return scores


def test_an_object_lies_where_its_depth_says() -> None:
    cells = scores_of((1.0, 3.0, "bed", 0.7)).cells("bed", 0)
    np.testing.assert_allclose(cells[:, 0], 3.05)
    assert np.abs(cells[:, 1] - 3.0).max() <= 2.0 * np.tan(np.radians(79.0 / 2)) * 0.1 + CELL_M


def test_the_best_score_of_a_cell_stays() -> None:
    scores = scores_of((0.0, 0.0, "bed", 0.4), (0.0, 0.0, "bed", 0.9), (0.0, 0.0, "bed", 0.5))
    near = scores.within_radius([(2.0, 0.0), (2.0, 1.0)], 0.5, floor=0)
    np.testing.assert_allclose(near, [[0.9], [0.0]], rtol=1e-6)


def test_floors_are_kept_apart() -> None:
    scores = scores_of((0.0, 0.0, "bed", 0.4))
    assert scores.names(1) == ()
    assert scores.within_box([(2.0, 0.0)], 1.0, floor=1).shape == (1, 0)


@pytest.mark.parametrize("depth_m", [0.0, 5.0, 9.0])
def test_what_has_no_depth_within_the_map_has_no_place(depth_m: float) -> None:
    scores = ObjectScores(MapConfig())
    frame = observation_at(0.0, 0.0, depth_m)
    scores.add(frame, detections_of({"bed": MIDDLE}, [0.9]), floor=0)
    assert len(scores.cells("bed", 0)) == 0
    np.testing.assert_array_equal(scores.within_radius([(2.0, 0.0)], 9.0, floor=0), [[0.0]])


@settings(max_examples=20)
@given(
    frames=st.lists(
        st.tuples(
            st.floats(-3.0, 3.0),
            st.floats(-3.0, 3.0),
            st.sampled_from(["bed", "sofa"]),
            st.sampled_from([0.25, 0.5, 1.0]),
        ),
        max_size=5,
    ),
    reach_m=st.floats(0.1, 4.0),
)
def test_circles_and_squares_against_a_loop(
    frames: list[tuple[float, float, str, float]], reach_m: float
) -> None:
    scores = scores_of(*frames)
    places = np.array([(0.0, 0.0), (2.0, 1.0), (-1.0, -2.0)])
    circle = scores.within_radius(places, reach_m, floor=0)
    square = scores.within_box(places, reach_m, floor=0)
    for column, name in enumerate(scores.names(0)):
        alone = [scores_of(frame) for frame in frames if frame[2] == name]
        worth = [frame[3] for frame in frames if frame[2] == name]
        for row, place in enumerate(places):
            offsets = [one.cells(name, 0) - place for one in alone]
            in_circle = [np.linalg.norm(o, axis=1).min() <= reach_m for o in offsets]
            in_square = [np.abs(o).max(axis=1).min() <= reach_m for o in offsets]
            assert circle[row, column] == max(
                (w for w, near in zip(worth, in_circle, strict=True) if near), default=0.0
            )
            assert square[row, column] == max(
                (w for w, near in zip(worth, in_square, strict=True) if near), default=0.0
            )
