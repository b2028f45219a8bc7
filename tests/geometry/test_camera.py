"""The pinhole camera against its equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.errors import InputError
from toponav.geometry import Intrinsics, back_project, project


def test_back_projection_is_equation_1() -> None:
    intrinsics = Intrinsics(5, 4, fx=3.0, fy=2.5, cx=1.7, cy=2.2)
    depth = np.random.default_rng(0).uniform(0.5, 5.0, (4, 5))
    inverse = np.linalg.inv(intrinsics.matrix)
    expected = np.array([[depth[v, u] * inverse @ [u, v, 1.0] for u in range(5)] for v in range(4)])
    np.testing.assert_allclose(back_project(depth, intrinsics), expected)


@given(st.integers(2, 40), st.integers(2, 40), st.floats(20, 150))
def test_projection_inverts_back_projection(width: int, height: int, hfov_deg: float) -> None:
    intrinsics = Intrinsics.from_hfov(width, height, hfov_deg)
    pixels = project(back_project(np.full((height, width), 2.0), intrinsics), intrinsics)
    v, u = np.mgrid[:height, :width]
    np.testing.assert_allclose(pixels, np.stack([u, v], axis=-1), atol=1e-9)


def test_field_of_view_spans_the_image_edge_to_edge() -> None:
    intrinsics = Intrinsics.from_hfov(640, 480, 79.0)
    assert math.isclose(math.degrees(intrinsics.hfov), 79.0)
    edge = (639.5 - intrinsics.cx) / intrinsics.fx
    assert math.isclose(math.degrees(math.atan(edge)), 39.5)


def test_points_behind_the_camera_do_not_project() -> None:
    assert np.isnan(project([[0.0, 0.0, -1.0]], Intrinsics.from_hfov(4, 4, 90.0))).all()


@pytest.mark.parametrize("hfov_deg", [0.0, 180.0, math.nan])
def test_impossible_fields_of_view_are_refused(hfov_deg: float) -> None:
    with pytest.raises(InputError, match="field of view"):
        Intrinsics.from_hfov(4, 4, hfov_deg)
