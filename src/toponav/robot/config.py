"""A robot in one YAML file: topics, camera, body, limits; and the profiles of known robots."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field

from toponav.config import NavigatorConfig, parse_config, preset
from toponav.config_model import ConfigModel
from toponav.errors import ConfigError
from toponav.robot.footprint import Footprint
from toponav.robot.motion import MotionConfig
from toponav.robot.obstacle_guard import GuardConfig
from toponav.robot.watchdog import WatchdogConfig

PLANNING_MARGIN_M = 0.04
"""Ways keep this much farther from obstacles than the body's sides, metres; and never nearer than
the body needs to turn in place."""

CONTACT_M = 0.07
"""What a bump was against lies so far before the body's end: most of a cell of the map, metres."""

EXPLAINED_M = 0.17
"""Within so much of the body's end a mapped obstacle explains a bump, metres."""

NAV2_ARRIVAL_M = 0.35
"""How near to a goal a walk ends where Nav2 drives, whose own tolerance is 0.25 m."""


Topic = Annotated[str, Field(pattern=r"^[/~]?[A-Za-z_][A-Za-z0-9_/]*$")]
"""A name that ROS takes for a topic."""


class CameraConfig(ConfigModel):
    """The RGB-D camera: what it publishes and where it sits."""

    color_topic: Topic = "camera/color/image_raw"
    """Colour images, rgb8 or bgr8, rectified; with `/compressed` at the end, JPEG or PNG."""

    depth_topic: Topic = "camera/aligned_depth_to_color/image_raw"
    """Depth aligned to colour, of the same size; 16UC1 in millimetres or 32FC1 in metres; with
    `/compressedDepth` at the end, as PNG."""

    info_topic: Topic = "camera/color/camera_info"
    """Intrinsics of the colour camera."""

    labels_topic: Topic = "camera/labels"
    """For the detector `labels`: segments of the colour image, 32SC1 indices into the names."""

    names_topic: Topic = "camera/label_names"
    """For the detector `labels`: a JSON list of category names, latched."""

    slop_s: float = Field(default=0.02, ge=0.0)
    """Colour and depth whose stamps differ by no more belong together, seconds."""

    extrinsics: Literal["fixed", "tf"] = "fixed"
    """Where the camera sits: as `xyz` and `tilt_deg` say, or as /tf and /tf_static do, for the
    frame that its camera_info names."""

    base_frame: str = "base_footprint"
    """With extrinsics `tf`: the frame of the pose topic's poses, its origin on the floor."""

    xyz: tuple[float, float, float] = (0.0, 0.0, 0.88)
    """The camera in the base frame, metres: forward, left, up from the foot point."""

    tilt_deg: float = 0.0
    """How far the camera looks down, degrees."""

    hfov_deg: float = Field(default=79.0, gt=0.0, lt=180.0)
    """Horizontal field of view, degrees: what a simulated robot of this kind has."""

    min_depth_m: float = Field(default=0.3, ge=0.0)
    """Nearer returns are dropped, metres."""

    max_depth_m: float = Field(default=5.0, gt=0.0)
    """Farther returns are dropped, metres."""


class RobotConfig(ConfigModel):
    """A robot."""

    profile: str = "generic"
    """Which known robot the other values start from."""

    camera: CameraConfig = Field(default_factory=CameraConfig)
    """Its RGB-D camera."""

    pose_topic: Topic = "odom"
    """Pose of the base's foot point, from SLAM or odometry."""

    pose_type: Literal["Odometry", "PoseStamped", "PoseWithCovarianceStamped"] = "Odometry"
    """Message type of the pose."""

    drive: Literal["cmd_vel", "goal_pose"] = "cmd_vel"
    """Velocities by our own follower, or goals for Nav2."""

    footprint: Footprint = Field(default_factory=Footprint)
    """The body seen from above."""

    panorama_views: int = Field(default=12, ge=1)
    """Views of a panorama, by turning in place; 1 for a camera that sees all around."""

    control_hz: float = Field(default=20.0, gt=0.0)
    """Commands a second."""

    max_frame_age_s: float = Field(default=1.0, gt=0.0)
    """On the way, the agent looks again after so long at the latest, seconds."""

    dry_run: bool = False
    """Do everything but send commands."""

    motion: MotionConfig = Field(default_factory=MotionConfig)
    """Speed limits."""

    guard: GuardConfig = Field(default_factory=GuardConfig)
    """What must be free ahead."""

    watchdog: WatchdogConfig = Field(default_factory=WatchdogConfig)
    """When to stand still."""

    @property
    def turn_deg(self) -> float:
        """The agent's turn: the spacing of a panorama's views."""
        return 30.0 if self.panorama_views < 4 else 360.0 / self.panorama_views


PROFILES: dict[str, dict[str, Any]] = {
    "generic": {},
    # Unitree Go2, 0.70 x 0.31 m, as in Section V of the paper: a D435i over the head, a lidar SLAM.
    "go2_d435i": {
        "camera": {"xyz": (0.30, 0.0, 0.45), "hfov_deg": 69.0},
        "pose_topic": "utlidar/robot_odom",
        "footprint": {"length_m": 0.70, "width_m": 0.31},
        "panorama_views": 9,
        "motion": {"max_speed": 0.5, "max_turn_rate": 0.8, "settle_s": 0.4},
    },
    # A round base of 0.35 m with a camera on a mast.
    "turtlebot": {
        "camera": {"xyz": (0.0, 0.0, 0.60), "hfov_deg": 69.0},
        "footprint": {"length_m": 0.36, "width_m": 0.36},
        "motion": {"max_speed": 0.3, "max_turn_rate": 1.0},
    },
}
"""What known robots have beside the defaults."""


def robot_config(spec: str, overrides: Mapping[str, Any] | None = None) -> RobotConfig:
    """The robot of a profile's name, or of a YAML file.

    Args:
        spec: Name, or path of a file that may name its `profile` and overrides what it says.
        overrides: Values that override both.

    Raises:
        ConfigError: No such profile or file, an unknown key, an impossible value.
    """
    values: dict[str, Any] = {"profile": spec}
    if spec not in PROFILES:
        values = _read_yaml(Path(spec))
    profile = values.setdefault("profile", "generic")
    if profile not in PROFILES:
        raise ConfigError(f"unknown robot {profile!r}; known: {', '.join(PROFILES)}, or a .yaml")
    merged = _merged(_merged(PROFILES[profile], values), overrides or {})
    return parse_config(RobotConfig, merged, spec)


def robot_yaml(config: RobotConfig) -> str:
    """Every value, for a file to start from."""
    return yaml.safe_dump(config.model_dump(mode="json"), sort_keys=False)


def navigator_config(robot: RobotConfig, preset_name: str = "default") -> NavigatorConfig:
    """The agent's parameters of a preset, fitted to a robot.

    Raises:
        ConfigError: Unknown preset.
    """
    turn, body = robot.turn_deg, robot.footprint
    radius_m = max(body.half_width_m + PLANNING_MARGIN_M, body.turning_radius_m)
    planner: dict[str, Any] = {"radius_m": radius_m}
    if robot.watchdog.keep_out:
        planner["keep_out"] = robot.watchdog.keep_out
    arrival_m = {} if robot.drive == "cmd_vel" else {"arrival_m": NAV2_ARRIVAL_M}
    recovery = {
        "contact_m": body.turning_radius_m + CONTACT_M,
        "explained_m": body.turning_radius_m + EXPLAINED_M,
    }
    locomotion = {"planner": planner, "follower": {"turn_deg": turn}, "recovery": recovery}
    changes: dict[str, Any] = {
        # The camera does not tilt by itself, so that nothing below an edge is looked at.
        "map": {"stairwells": False, "max_depth_m": robot.camera.max_depth_m},
        "panorama": {"views": robot.panorama_views, "spacing_deg": turn},
        "locomotion": {**locomotion, **arrival_m},
    }
    values = preset(preset_name).model_dump()
    return parse_config(NavigatorConfig, _merged(values, changes), "the robot")


def _merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Nested values, with those of `changes` put over those of `base`."""
    merged = dict(base)
    for key, value in changes.items():
        inner = merged.get(key)
        if isinstance(inner, Mapping) and isinstance(value, Mapping):
            value = _merged(inner, value)  # noqa: PLW2901
        merged[key] = value
    return merged


def _read_yaml(path: Path) -> dict[str, Any]:
    if path.suffix not in (".yaml", ".yml"):
        raise ConfigError(f"unknown robot {str(path)!r}; known: {', '.join(PROFILES)}, or a .yaml")
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"cannot read the robot {path}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ConfigError(f"the robot {path} is not YAML: {error}") from error
    if values is None:
        return {}
    if not isinstance(values, dict):
        raise ConfigError(f"the robot {path} is not a mapping of names to values")
    return values
