"""Groups of objects against brute force and by hand."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from drawn_map import detections_of, observation_at
from toponav.baselines.object_groups import linked, object_groups
from toponav.baselines.object_scores import ObjectScores
from toponav.mapping.semantic_map import MapConfig

MIDDLE = (18, 13, 22, 17)


@given(
    st.lists(st.tuples(st.integers(0, 40), st.integers(0, 40)), max_size=25),
    st.floats(0.5, 8.0),
)
def test_linking_against_merging_one_pair_after_the_other(
    points: list[tuple[int, int]], distance: float
) -> None:
    positions = np.array(points, dtype=np.float64).reshape(-1, 2)
    label = list(range(len(points)))
    for a in range(len(points)):
        for b in range(a):
            if np.hypot(*(positions[a] - positions[b])) <= distance:
                label = [label[a] if one == label[b] else one for one in label]
    expected = [[k for k in range(len(points)) if label[k] == one] for one in dict.fromkeys(label)]
    assert [rows.tolist() for rows in linked(positions, distance)] == expected


def test_objects_side_by_side_are_a_group_and_one_across_the_room_is_its_own() -> None:
    scores = ObjectScores(MapConfig())
    for x, y, label in ((0.0, 0.0, "bed"), (0.3, 0.0, "lamp"), (0.0, 3.0, "bed")):
        scores.add(observation_at(x, y), detections_of({label: MIDDLE}, [1.0]), floor=0)
    near, far = object_groups(scores, 0, 0.5)
    assert near.names == ("bed", "lamp")
    assert far.names == ("bed",)
    bed, lamp = scores.cells("bed", 0), scores.cells("lamp", 0)
    near_bed = bed[bed[:, 1] < 1.5].mean(axis=0)
    np.testing.assert_allclose(near.centre, (near_bed + lamp.mean(axis=0)) / 2)
    assert object_groups(scores, 1, 0.5) == ()
