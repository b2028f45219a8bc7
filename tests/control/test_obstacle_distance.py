"""Distances to obstacles against SciPy's."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from toponav.control.obstacle_distance import obstacle_distance


@pytest.mark.parametrize("share", [0.001, 0.01, 0.1, 0.6, 1.0])
@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (37, 60), (90, 13)])
def test_distances_are_the_exact_ones(share: float, shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(hash((share, shape)) % 2**32)
    for _ in range(5):
        occupied = rng.random(shape) < share
        if not occupied.any():
            assert np.isinf(obstacle_distance(occupied)).all()
        else:
            np.testing.assert_array_equal(
                obstacle_distance(occupied), distance_transform_edt(~occupied)
            )
