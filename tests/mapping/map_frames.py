"""Synthetic observations for the tests of the map."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.types import Detections, Observation

CAMERA = Intrinsics.from_hfov(40, 30, 79.0)
CAMERA_HEIGHT = 0.88


def observe(
    depth: ArrayLike,
    foot: ArrayLike = (0.0, 0.0, 0.0),
    yaw: float = 0.0,
    pitch_down: float = 0.0,
    rgb: NDArray[np.uint8] | None = None,
) -> Observation:
    """An agent's view: the camera 0.88 m over the foot point."""
    image = np.asarray(depth, np.float32)
    height, width = image.shape
    camera = Intrinsics.from_hfov(width, height, 79.0)
    base = Pose.from_yaw(yaw, foot)
    c, s = np.cos(pitch_down), np.sin(pitch_down)
    tilt = Pose.from_rotation([[c, 0, s], [0, 1, 0], [-s, 0, c]], (0.0, 0.0, CAMERA_HEIGHT))
    return Observation(
        rgb=np.full((height, width, 3), 100, np.uint8) if rgb is None else rgb,
        depth=image,
        world_from_camera=base @ tilt @ BODY_FROM_OPTICAL,
        world_from_base=base,
        intrinsics=camera,
    )


def floor_depth(
    pitch_down: float = 0.5, wall_distance: float = 3.0, camera: Intrinsics = CAMERA
) -> NDArray[np.float32]:
    """What an agent sees in an open hall: the floor, and a wall across at some distance."""
    tilted = observe(np.zeros((camera.height, camera.width)), pitch_down=pitch_down)
    rays = camera.rays() @ tilted.world_from_camera.rotation.T
    with np.errstate(divide="ignore"):
        to_floor = np.where(rays[..., 2] < 0.0, -CAMERA_HEIGHT / rays[..., 2], np.inf)
        to_wall = np.where(rays[..., 0] > 0.0, wall_distance / rays[..., 0], np.inf)
    depth = np.minimum(to_floor, to_wall)
    return np.where(np.isfinite(depth), depth, 0.0).astype(np.float32)


def nothing_seen(observation: Observation) -> Detections:
    return Detections.empty(*observation.depth.shape)


def detections_of(*labelled: tuple[str, NDArray[np.bool_]]) -> Detections:
    masks = np.array([mask for _, mask in labelled])
    count = len(labelled)
    return Detections(
        tuple(label for label, _ in labelled),
        np.ones(count, np.float32),
        np.zeros((count, 4), np.float32),
        masks,
    )


def random_frame(rng: np.random.Generator) -> tuple[Observation, Detections]:
    """A frame of smooth random surfaces around the floor, with holes, random pose and masks."""
    height, width = CAMERA.height, CAMERA.width
    pitch = float(rng.uniform(-0.2, 0.8))
    depth = floor_depth(pitch, float(rng.uniform(1.0, 4.0)))
    depth = depth + rng.normal(0.0, 0.02, depth.shape).astype(np.float32) * (depth > 0)
    depth[rng.random(depth.shape) < 0.1] = 0.0
    patch = (slice(*sorted(rng.integers(0, height, 2))), slice(*sorted(rng.integers(0, width, 2))))
    depth[patch] *= np.float32(rng.uniform(0.4, 1.0))
    observation = observe(
        np.maximum(depth, 0.0),
        foot=(*rng.uniform(-3.0, 3.0, 2), 0.0),
        yaw=float(rng.uniform(-np.pi, np.pi)),
        pitch_down=pitch,
        rgb=rng.integers(0, 256, (height, width, 3), dtype=np.uint8),
    )
    masks = rng.random((3, height, width)) < 0.3
    masks[0, :, : width // 2] = False
    labels = ("chair", "stairs", "chair")
    return observation, detections_of(*zip(labels, masks, strict=True))
