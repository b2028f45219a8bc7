import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.geometry.neighbourhoods import Neighbourhoods


@given(st.integers(0, 2**32 - 1), st.integers(0, 12), st.integers(0, 60), st.floats(0.1, 3.0))
def test_near_is_what_brute_force_finds(seed: int, places: int, points: int, radius: float) -> None:
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-4.0, 4.0, (places, 2))
    cloud = rng.uniform(-5.0, 5.0, (points, 3)).astype(np.float32)
    near = Neighbourhoods(centers, radius).near(cloud, (-1.0, 2.0))
    level = cloud[(cloud[:, 2] >= -1.0) & (cloud[:, 2] <= 2.0)].astype(np.float64)
    distance = np.linalg.norm(level[None, :, :2] - centers[:, None], axis=2)
    inside = np.where(distance < radius, distance, np.inf)
    assert near.counts.tolist() == np.isfinite(inside).sum(axis=1).tolist()
    assert near.distances.tolist() == pytest.approx(inside.min(axis=1, initial=np.inf).tolist())


def test_a_point_at_exactly_the_radius_is_outside() -> None:
    points = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 0.0]])
    centers = np.array([[0.0, 0.0], [2.5, 0.0]])
    assert Neighbourhoods(centers, 1.0).near(points).counts.tolist() == [1, 0]
    assert Neighbourhoods(centers, 1.001).near(points).counts.tolist() == [2, 0]
