"""Observations and detections refuse what breaks their contract, in one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from toponav.errors import InputError, ObservationError
from toponav.geometry import Intrinsics, Pose
from toponav.types import Detections, Observation


def observation(**changes: Any) -> Observation:
    values: dict[str, Any] = {
        "rgb": np.zeros((3, 4, 3), np.uint8),
        "depth": np.ones((3, 4), np.float32),
        "world_from_camera": Pose.identity(),
        "world_from_base": Pose.identity(),
        "intrinsics": Intrinsics.from_hfov(4, 3, 79.0),
    }
    return Observation(**{**values, **changes})


def depth_with(value: float) -> np.ndarray:
    depth = np.ones((3, 4), np.float32)
    depth[1, 2] = value
    return depth


def test_no_return_is_zero_and_valid() -> None:
    assert observation(depth=depth_with(0.0)).depth[1, 2] == 0.0


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -0.5])
def test_depth_that_is_no_distance_is_refused(value: float) -> None:
    with pytest.raises(ObservationError, match="write 0 where there is no return"):
        observation(depth=depth_with(value))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"rgb": np.zeros((3, 4, 3), np.float32)}, r"rgb must be uint8 \(3, 4, 3\), not float32"),
        ({"rgb": np.zeros((3, 4, 4), np.uint8)}, r"not uint8 \(3, 4, 4\)"),
        ({"rgb": np.zeros((4, 3, 3), np.uint8)}, r"not uint8 \(4, 3, 3\)"),
        ({"depth": np.ones((3, 4))}, r"depth must be float32 \(3, 4\), not float64"),
        ({"depth": np.ones((3, 4, 1), np.float32)}, r"not float32 \(3, 4, 1\)"),
    ],
)
def test_wrong_shapes_and_types_are_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ObservationError, match=says) as error_info:
        observation(**changes)
    assert isinstance(error_info.value, InputError)  # exit code 2
    assert "\n" not in str(error_info.value)


def test_detections_must_be_as_many_everywhere() -> None:
    three = (np.ones(3, np.float32), np.zeros((3, 4), np.float32), np.zeros((3, 2, 2), np.bool_))
    assert len(Detections(("a", "b", "c"), *three)) == 3
    with pytest.raises(ObservationError, match="2 detections need"):
        Detections(("a", "b"), *three)


def test_no_detections_have_the_size_of_the_image() -> None:
    nothing = Detections.empty(3, 4)
    assert len(nothing) == 0
    assert nothing.masks.shape == (0, 3, 4)
