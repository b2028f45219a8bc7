"""Images of balls that hang in the air, from anywhere, and what a detector says of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.types import Detections, Observation

CAMERA = Intrinsics.from_hfov(80, 60, 79.0)
BACKGROUND_M = 6.0
EYE_M = 0.88


@dataclass(frozen=True)
class Ball:
    """A ball at (x, y), in the height of the eye."""

    x: float
    y: float
    radius: float = 0.3


def look_from(x: float, y: float, at: tuple[float, float] = (0.0, 0.0)) -> tuple[Pose, Pose]:
    """The poses of the base and of the camera that looks from one place at another."""
    yaw = math.atan2(at[1] - y, at[0] - x)
    base = Pose.from_yaw(yaw, (x, y, 0.0))
    return base, Pose.from_yaw(yaw, (x, y, EYE_M)) @ BODY_FROM_OPTICAL


def frame(
    balls: Sequence[Ball], x: float, y: float, at: tuple[float, float] = (0.0, 0.0)
) -> tuple[Observation, list[NDArray[np.bool_]]]:
    """What is seen, and the mask of each ball; nearer ones hide those behind them."""
    base, eye = look_from(x, y, at)
    rays = CAMERA.rays()
    depth = np.full(rays.shape[:2], BACKGROUND_M)
    owner = np.full(rays.shape[:2], -1)
    for k, ball in enumerate(balls):
        center = eye.inverse().apply(np.array([ball.x, ball.y, EYE_M]))
        a, b = (rays**2).sum(axis=-1), rays @ center
        under = b**2 - a * (center @ center - ball.radius**2)
        z = np.where(under > 0.0, (b - np.sqrt(np.maximum(under, 0.0))) / a, np.inf)
        nearer = (z > 0.0) & (z < depth)
        depth[nearer], owner[nearer] = z[nearer], k
    observation = Observation(
        rgb=np.zeros((*depth.shape, 3), np.uint8),
        depth=depth.astype(np.float32),
        world_from_camera=eye,
        world_from_base=base,
        intrinsics=CAMERA,
    )
    return observation, [owner == k for k in range(len(balls))]


def said(*found: tuple[str, float, NDArray[np.bool_]]) -> Detections:
    """Detections by label, score and mask."""
    masks = np.array([mask for *_, mask in found], np.bool_).reshape(-1, 60, 80)
    boxes = np.tile(np.array([0, 0, 80, 60], np.float32), (len(found), 1))
    return Detections(
        tuple(label for label, *_ in found),
        np.array([score for _, score, _ in found], np.float32),
        boxes.reshape(-1, 4),
        masks,
    )
