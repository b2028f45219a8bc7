"""Collecting a panorama: which of the turning camera's images become views."""

from __future__ import annotations

import math

import numpy as np
import pytest

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import FrameUpdate
from toponav.reasoning.panorama import Panorama, PanoramaConfig
from toponav.types import Detections, Observation

CAMERA = Intrinsics.from_hfov(16, 12, 79.0)


def image(yaw: float) -> Observation:
    """A camera in the middle of an empty place, looking along `yaw`."""
    base = Pose.from_yaw(yaw, (0.0, 0.0, 0.0))
    eye = Pose.from_yaw(yaw, (0.0, 0.0, 0.88)) @ BODY_FROM_OPTICAL
    rgb, depth = np.zeros((12, 16, 3), np.uint8), np.full((12, 16), 3.0, np.float32)
    return Observation(rgb, depth, eye, base, CAMERA)


def collect(config: PanoramaConfig, turn_deg: float) -> tuple[Panorama, int]:
    """Turn in place until the panorama is whole; how many turns that took."""
    panorama, semantic_map, turns = Panorama(config, 0.05), SemanticMap(), 0
    while True:
        observation = image(math.radians(turn_deg * turns))
        update: FrameUpdate = semantic_map.integrate(observation, Detections.empty(12, 16))
        if not panorama.add(observation, Detections.empty(12, 16), update):
            return panorama, turns
        turns += 1


@pytest.mark.parametrize(
    ("views", "spacing", "turns"), [(12, 30.0, 11), (6, 60.0, 10), (4, 90.0, 9), (6, 30.0, 5)]
)
def test_views_are_taken_at_their_spacing(views: int, spacing: float, turns: int) -> None:
    panorama, turned = collect(PanoramaConfig(views=views, spacing_deg=spacing), 30.0)
    bearings = np.unwrap([shot.bearing for shot in panorama.shots])
    assert len(bearings) == views
    np.testing.assert_allclose(np.diff(bearings), math.radians(spacing), atol=1e-9)
    assert turned == turns


def test_a_robot_that_turns_a_little_short_still_takes_every_view() -> None:
    panorama, turned = collect(PanoramaConfig(), 28.0)
    assert len(panorama.shots) == 12
    assert turned == 11
