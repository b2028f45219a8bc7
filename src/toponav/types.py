"""What crosses from room to room: observations, actions, detections and the Agent contract."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from toponav.errors import ObservationError
from toponav.geometry import Intrinsics, Pose

STRUCTURE_CATEGORIES = frozenset({"wall", "floor", "ceiling", "door", "window", "stairs"})
"""Categories that are part of the building: never targets."""


class Action(IntEnum):
    """The protocol's six actions: 0.25 m forward, 30 degree turns and tilts."""

    STOP = 0
    MOVE_FORWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3
    LOOK_UP = 4
    LOOK_DOWN = 5


@dataclass(frozen=True, eq=False)
class Observation:
    """One posed RGB-D image, O_t = (V_t, P_t) of Section III-A. Holds no ground truth, ever.

    Attributes:
        rgb: (H, W, 3) uint8.
        depth: (H, W) float32, the z coordinate in the camera frame in metres; 0 means no return.
        world_from_camera: Pose of the optical camera frame.
        world_from_base: Pose of the agent's foot point on the floor; x forward, z up.
        intrinsics: The camera of both images.
        collided: Whether the last action was cut short by an obstacle.
        step: Actions taken so far in the episode.
        timestamp_s: Time of the image, seconds.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    world_from_camera: Pose
    world_from_base: Pose
    intrinsics: Intrinsics
    collided: bool = False
    step: int = 0
    timestamp_s: float = 0.0

    def __post_init__(self) -> None:
        shape = (self.intrinsics.height, self.intrinsics.width)
        if self.rgb.dtype != np.uint8 or self.rgb.shape != (*shape, 3):
            raise ObservationError(
                f"rgb must be uint8 {(*shape, 3)}, not {self.rgb.dtype} {self.rgb.shape}"
            )
        if self.depth.dtype != np.float32 or self.depth.shape != shape:
            raise ObservationError(
                f"depth must be float32 {shape}, not {self.depth.dtype} {self.depth.shape}"
            )
        if not np.isfinite(self.depth).all() or (self.depth.size and self.depth.min() < 0.0):
            raise ObservationError(
                "depth holds NaN, infinite or negative values: write 0 where there is no return"
            )


@dataclass(frozen=True, eq=False)
class Detections:
    """What a detector saw in one image; N may be 0.

    Attributes:
        labels: N category names.
        scores: (N,) float32 in [0, 1].
        boxes: (N, 4) float32, x_min, y_min, x_max, y_max in pixels, max exclusive.
        masks: (N, H, W) bool.
        masks_are_boxes: Whether the masks are only the boxes, filled, so that the depth image has
            yet to tell the objects in them (`toponav.perception.object_masks`).
    """

    labels: tuple[str, ...]
    scores: NDArray[np.float32]
    boxes: NDArray[np.float32]
    masks: NDArray[np.bool_]
    masks_are_boxes: bool = False

    def __post_init__(self) -> None:
        n = len(self.labels)
        if self.scores.shape != (n,) or self.boxes.shape != (n, 4) or self.masks.shape[:1] != (n,):
            raise ObservationError(
                f"{n} detections need scores ({n},), boxes ({n}, 4) and masks ({n}, H, W), not "
                f"{self.scores.shape}, {self.boxes.shape} and {self.masks.shape}"
            )

    def __len__(self) -> int:
        return len(self.labels)

    def where(self, kept: NDArray[np.bool_]) -> Detections:
        """Those of the N detections for which (N,) `kept` holds."""
        rows = np.flatnonzero(kept)
        return Detections(
            tuple(self.labels[row] for row in rows),
            self.scores[rows],
            self.boxes[rows],
            self.masks[rows],
            self.masks_are_boxes,
        )

    @classmethod
    def empty(cls, height: int, width: int) -> Detections:
        """No detections in an image of that size."""
        return cls(
            (),
            np.zeros(0, np.float32),
            np.zeros((0, 4), np.float32),
            np.zeros((0, height, width), np.bool_),
        )


@dataclass(frozen=True)
class Instance:
    """One object (or piece of structure) of a scene; ground truth, for scenes and simulators.

    Attributes:
        id: Index into the scene's instances; what an instance image holds.
        name: Unique in the scene.
        category: Free string; `STRUCTURE_CATEGORIES` are never targets.
    """

    id: int
    name: str
    category: str


@dataclass(frozen=True, eq=False)
class SemanticFrame:
    """Ground truth of one image.

    Attributes:
        instance_ids: (H, W) int32 indices into `instances`; -1 where nothing was hit.
        instances: All instances of the scene, in id order.
        depth: (H, W) float32, true z coordinates in the camera frame, metres, at any range; 0 where
            nothing was hit.
        world_from_camera: True pose of the optical camera frame.
        intrinsics: The camera.
    """

    instance_ids: NDArray[np.int32]
    instances: tuple[Instance, ...]
    depth: NDArray[np.float32]
    world_from_camera: Pose
    intrinsics: Intrinsics


class SemanticSource(Protocol):
    """The handle through which a runner lets the oracle detector see ground truth."""

    def semantic_frame(self) -> SemanticFrame:
        """Labels of the image last observed."""
        ...


@runtime_checkable
class Agent(Protocol):
    """What every navigation method is: Navigator, the baselines, and a user's own."""

    def reset(self, goal: str) -> None:
        """Forget the last episode and look for an object of category `goal`."""
        ...

    def act(self, observation: Observation) -> Action:
        """The next action. Called once a step, from the first observation on."""
        ...

    def close(self) -> None:
        """Release what the agent holds; it is not used afterwards."""
        ...
