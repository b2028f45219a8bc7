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
    """Deviation of the reported position after one metre walked, metres, along and across."""

    drift_yaw_per_m: float = Field(default=0.0, ge=0.0)
    """Deviation of the reported yaw after one metre walked, radians."""

    drift_yaw_per_rad: float = Field(default=0.0, ge=0.0)
    """Deviation of the reported yaw after one radian turned, radians."""

    actuation: float = Field(default=0.0, ge=0.0)
    """Relative deviation of every step and turn that is carried out."""


class SensorNoise:
    """Draws one episode's noise from its generator; draws nothing where a kind is off."""

    def __init__(self, config: NoiseConfig, rng: np.random.Generator) -> None:
        """Start without drift."""
        self._config = config
        self._rng = rng
        self._reported_from_true = Pose.identity()

    def actuated(self, amount: float) -> float:
        """What a motor makes of a commanded distance or angle; it never runs backwards."""
        if not self._config.actuation:
            return amount
        return max(0.0, amount * (1.0 + self._config.actuation * self._rng.standard_normal()))

    def moved(self, before: Pose, after: Pose) -> None:
        """Let the reported pose drift over one motion of the base.

        Odometry adds up increments, each with an error in the base's own frame (Thrun, Burgard,
        Fox: "Probabilistic Robotics", 2005, section 5.4), so an error in yaw bends the rest of the
        way. Variances are proportional to the motion: the drift is a random walk.

        Args:
            before: True `world_from_base` before the motion.
            after: The same after it.
        """
        config = self._config
        if not (config.drift_per_m or config.drift_yaw_per_m or config.drift_yaw_per_rad):
            return
        increment = before.inverse() @ after
        distance_m, turn = float(np.linalg.norm(increment.translation)), abs(increment.yaw)
        along, across, yaw = self._rng.standard_normal(3)
        sigma_m = config.drift_per_m * np.sqrt(distance_m)
        sigma_yaw = np.hypot(
            config.drift_yaw_per_m * np.sqrt(distance_m), config.drift_yaw_per_rad * np.sqrt(turn)
        )
        error = Pose.from_yaw(sigma_yaw * yaw, (sigma_m * along, sigma_m * across, 0.0))
        self._reported_from_true = self._reported_from_true @ after @ error @ after.inverse()

    def reported(self, world_from_base: Pose) -> Pose:
        """The pose as odometry reports it; height and tilt are known (from an IMU, say)."""
        return self._reported_from_true @ world_from_base

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
