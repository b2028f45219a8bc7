"""The simulator with a robot's body and camera."""

from __future__ import annotations

from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.sensors import NoiseConfig
from toponav.geometry import Pose
from toponav.robot.config import CameraConfig, RobotConfig
from toponav.robot.frames import FrameReader
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
        self._camera_pose = FrameReader(camera).base_from_camera
        super().__init__(scene, _env_config(camera, robot.radius_m, size, noise))

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
