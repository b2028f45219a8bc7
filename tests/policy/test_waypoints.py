"""p_target is the best of the points that are safe and admissible."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from toponav.policy.affordances import Affordances
from toponav.policy.waypoints import select_waypoint


def affordances(total: list[float], safe: list[bool] | None = None) -> Affordances:
    points = np.stack([np.arange(len(total)), np.zeros(len(total)), np.ones(len(total))], axis=-1)
    mask = np.array(safe if safe is not None else [True] * len(total), dtype=np.bool_)
    values = np.where(mask, np.array(total, dtype=np.float64), 0.0)
    return Affordances(points.astype(np.float32), {}, mask, values)


rows = st.lists(st.tuples(st.integers(0, 5).map(float), st.booleans(), st.booleans()), max_size=15)


@given(rows)
def test_it_is_the_first_best_of_the_candidates(rows: list[tuple[float, bool, bool]]) -> None:
    given_ = affordances([row[0] for row in rows], [row[1] for row in rows])
    chosen = select_waypoint(given_, np.array([row[2] for row in rows], dtype=np.bool_))
    candidates = [(-value, k) for k, (value, safe, allowed) in enumerate(rows) if safe and allowed]
    if not candidates:
        assert chosen is None
    else:
        assert chosen is not None
        assert chosen.tolist() == [float(min(candidates)[1]), 0.0, 1.0]


def test_an_admissible_point_of_no_affordance_beats_stopping() -> None:
    chosen = select_waypoint(affordances([0.0, 3.0]), np.array([True, False]))
    assert chosen is not None
    assert chosen[0] == 0.0
