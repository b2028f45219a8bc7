"""The simulator with a robot's body and camera."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.sensors import NoiseConfig
from toponav.geometry import Pose
from toponav.robot.config import CameraConfig, RobotConfig
from toponav.robot.frames import camera_mount
from toponav.scenes.mesh import Scene

BODY_HEIGHT_M = 0.88
"""Of the simulated body at least, metres: it keeps out from under tables, as its camera must."""


class RobotEnv(HouseEnv):
    """A `HouseEnv` whose camera sits where the robot's does, tilt included."""

    def __init__(
        self,
        scene: Scene,
        robot: RobotConfig,
        size: tuple[int, int],
        noise: NoiseConfig | None = None,
    ) -> None:
        """Load a scene.

        Args:
            scene: Where the robot is.
            robot: Its body and camera.
            size: Width and height of the images.
            noise: Of depth and pose; none by default.

        Raises:
            SceneError: The robot finds nowhere to stand.
        """
        camera = robot.camera
        self._camera_pose = camera_mount(camera)
        self.footprint = robot.footprint
        self._circles = robot.footprint.circles()
        self.turn_collided = False
        """Whether the last turn was cut short."""
        radius_m = robot.footprint.half_width_m
        super().__init__(scene, _env_config(camera, radius_m, size, noise))

    def drive(self, distance: float, turn: float) -> None:
        """Turn, then go straight on; either is cut short where any part of the body would touch.

        Args:
            distance: Metres along the new heading; a negative one goes back.
            turn: Radians, counter-clockwise.

        Raises:
            EpisodeError: The environment has not been reset.
        """
        before = self.position
        fitted = self._fits(before, self.yaw)  # if not, it may go anywhere to get out
        turned = math.remainder(self.yaw + turn, math.tau)
        self.turn_collided = fitted and not self._fits(before, turned)
        if self.turn_collided:
            turn, turned = 0.0, self.yaw
        super().drive(distance, turn)
        if fitted and not self._fits(self.position, turned):
            self.position, self.collided = before, True

    def _fits(self, position: NDArray[np.float64], yaw: float) -> bool:
        """Whether the whole body can be at a pose: its middle is, or it could not be there."""
        if len(self._circles) == 1:
            return True
        ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        return all(self.surface.is_navigable(position + along * ahead) for along in self._circles)

    def _base_from_camera(self) -> Pose:
        return self._camera_pose


def _env_config(
    camera: CameraConfig, radius_m: float, size: tuple[int, int], noise: NoiseConfig | None
) -> HouseEnvConfig:
    height_m = max(BODY_HEIGHT_M, camera.xyz[2])
    return HouseEnvConfig(
        width=size[0],
        height=size[1],
        hfov_deg=camera.hfov_deg,
        camera_height_m=camera.xyz[2],
        min_depth_m=camera.min_depth_m,
        max_depth_m=camera.max_depth_m,
        body=AgentBody(radius=radius_m, height=height_m),
        noise=noise or NoiseConfig(),
    )
