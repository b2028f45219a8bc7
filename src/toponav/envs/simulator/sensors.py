"""The depth range, and the noise of real sensors and motors: off unless asked for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.ndimage import map_coordinates

from toponav.config_model import ConfigModel
from toponav.geometry import Pose

# Nguyen, Izadi, Lovell: "Modeling Kinect sensor noise for improved 3D reconstruction and tracking"
# (3DIMPVT 2012): axial sigma = 0.0012 + 0.0019 (z - 0.4)^2 metres, lateral sigma 0.8 pixels.
AXIAL_OFFSET_M = 0.0012
AXIAL_FACTOR = 0.0019
AXIAL_NEAREST_M = 0.4
LATERAL_SIGMA_PX = 0.8


class NoiseConfig(ConfigModel):
    """How far sensors and motors are from ideal; all zero by default."""

    depth: bool = False
    """Kinect noise on depth (Nguyen et al. 2012): axial by distance, lateral by pixels."""

    drift_per_m: float = Field(default=0.0, ge=0.0)
    """Random walk of the reported position: its deviation after one metre, as a fraction."""

    drift_yaw_per_m: float = Field(default=0.0, ge=0.0)
    """Random walk of the reported yaw: its deviation after one metre, radians."""

    actuation: float = Field(default=0.0, ge=0.0)
    """Relative deviation of every step and turn that is carried out."""


class SensorNoise:
    """Draws one episode's noise from its generator; draws nothing where a kind is off."""

    def __init__(self, config: NoiseConfig, rng: np.random.Generator) -> None:
        """Start without drift."""
        self._config = config
        self._rng = rng
        self._drift = np.zeros(3)

    def actuated(self, amount: float) -> float:
        """What a motor makes of a commanded distance or angle."""
        if not self._config.actuation:
            return amount
        return max(0.0, amount * (1.0 + self._config.actuation * self._rng.standard_normal()))

    def travelled(self, distance_m: float) -> None:
        """Let the reported pose drift over a distance walked."""
        config = self._config
        if not (config.drift_per_m or config.drift_yaw_per_m):
            return
        scale = np.array([config.drift_per_m, config.drift_per_m, config.drift_yaw_per_m])
        self._drift += scale * np.sqrt(distance_m) * self._rng.standard_normal(3)

    def reported(self, world_from_base: Pose) -> Pose:
        """The pose as odometry reports it."""
        if not self._drift.any():
            return world_from_base
        x, y, z = world_from_base.translation
        dx, dy, dyaw = self._drift
        return Pose.from_yaw(world_from_base.yaw + dyaw, (x + dx, y + dy, z))

    def measured(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """(H, W) depth as the sensor measures it; 0 stays 0."""
        if not self._config.depth:
            return depth
        jitter = LATERAL_SIGMA_PX * self._rng.standard_normal((2, *depth.shape))
        pixels = np.indices(depth.shape) + jitter
        shifted = map_coordinates(depth, pixels, order=0, mode="nearest")
        sigma = AXIAL_OFFSET_M + AXIAL_FACTOR * (shifted - AXIAL_NEAREST_M) ** 2
        noisy = shifted + sigma * self._rng.standard_normal(depth.shape)
        return np.where(shifted > 0.0, np.maximum(noisy, 0.0), 0.0).astype(np.float32)


def clip_range(
    depth: NDArray[np.float32], nearest_m: float, farthest_m: float
) -> NDArray[np.float32]:
    """Depth outside the sensor's range gives no return, 0."""
    inside = (depth >= nearest_m) & (depth <= farthest_m)
    return np.where(inside, depth, np.float32(0.0))
