"""The environment seam: a gymnasium.Env of posed RGB-D images, and the oracle beside it."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from toponav.geometry import Intrinsics, Pose
from toponav.types import Observation, SemanticFrame


class Oracle(Protocol):
    """Ground truth of the running episode, for evaluation alone (`env.unwrapped.oracle`)."""

    def semantic_frame(self) -> SemanticFrame:
        """Labels of the image last observed."""
        ...

    def categories(self) -> tuple[str, ...]:
        """Categories that have at least one reachable viewpoint, sorted; structure left out."""
        ...

    def distance_to_goal(self) -> float:
        """DTG: geodesic distance from the agent to the nearest viewpoint of the target, metres.

        Infinite when there is no path.
        """
        ...

    def viewpoints(self, category: str) -> NDArray[np.float64]:
        """(N, 3) viewpoints of all instances of a category (PROTOCOL: within 1 m, seeing it)."""
        ...

    def geodesic_distance(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> float:
        """Shortest path on the navigable surface between two points, metres; may be infinite."""
        ...


def observation_from_dict(observation: dict[str, Any], intrinsics: Intrinsics) -> Observation:
    """The typed observation behind a gymnasium Dict observation.

    Args:
        observation: Keys `rgb` (H, W, 3) uint8, `depth` (H, W) float32, `world_from_camera` and
            `world_from_base` (4, 4) float64, `collided` int, `step` (1,) int64, `timestamp_s` (1,).
        intrinsics: The camera.
    """
    return Observation(
        rgb=observation["rgb"],
        depth=observation["depth"],
        world_from_camera=Pose(observation["world_from_camera"]),
        world_from_base=Pose(observation["world_from_base"]),
        intrinsics=intrinsics,
        collided=bool(observation["collided"]),
        step=int(observation["step"][0]),
        timestamp_s=float(observation["timestamp_s"][0]),
    )
