"""Ground truth of made-up images, for detectors that read it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.types import Instance, SemanticFrame

EYE_M = 0.88
"""Height of the camera."""


def true_frame(
    ids: ArrayLike, categories: Sequence[str] = (), depth_m: ArrayLike = 2.0, yaw: float = 0.0
) -> SemanticFrame:
    """Instances 0, 1, ... of these categories in an image, at a distance, seen from the origin."""
    instance_ids = np.asarray(ids, np.int32)
    height, width = instance_ids.shape
    return SemanticFrame(
        instance_ids,
        tuple(Instance(k, f"{name}_{k}", name) for k, name in enumerate(categories)),
        np.broadcast_to(np.asarray(depth_m, np.float32), instance_ids.shape).copy(),
        Pose.from_yaw(yaw, (0.0, 0.0, EYE_M)) @ BODY_FROM_OPTICAL,
        Intrinsics.from_hfov(width, height, 79.0),
    )


class Truth:
    """A source whose image can be changed."""

    def __init__(self, frame: SemanticFrame) -> None:
        self.frame = frame

    def semantic_frame(self) -> SemanticFrame:
        return self.frame
