"""The embedded simulator as a gymnasium environment: the protocol's agent in one scene."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pydantic import Field
from scipy.spatial.transform import Rotation

from toponav.categories import HM3D_TARGETS, MP3D_TARGETS, canonical, readable
from toponav.config_model import ConfigModel
from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.oracle import SceneOracle
from toponav.envs.simulator.raycaster import RayCaster
from toponav.envs.simulator.renderer import CameraRenderer
from toponav.envs.simulator.renderers import RendererName, make_renderer
from toponav.envs.simulator.sensors import NoiseConfig, SensorNoise, clip_range
from toponav.envs.surface import Surface
from toponav.errors import EpisodeError, InputError
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.scenes.mesh import Scene, SceneEpisode
from toponav.types import STRUCTURE_CATEGORIES, Action, Observation, SemanticFrame

SUCCESS_RADIUS_M = 0.1
"""The reward's radius: the benchmark's."""

MAX_TILT_STEPS = 2
"""Looking up or down stops at two tilts, 60 degrees."""

START_TOLERANCE_M = 0.3
"""A start this near to the navigable surface is moved onto it."""

MIN_SAMPLED_DISTANCE_M, MAX_SAMPLED_DISTANCE_M = 3.0, 30.0
"""Geodesic distance of drawn starts from their goal (Habitat's episodes: 1 to 30 m)."""

SAMPLE_TRIES = 100


class HouseEnvConfig(ConfigModel):
    """The protocol's agent, camera and limits (PROTOCOL, habitat-lab's ObjectNav)."""

    width: int = Field(default=640, ge=1)
    """Columns of the images."""

    height: int = Field(default=480, ge=1)
    """Rows of the images."""

    hfov_deg: float = Field(default=79.0, gt=0.0, lt=180.0)
    """Horizontal field of view, degrees."""

    camera_height_m: float = 0.88
    """Height of the camera above the agent's foot point."""

    min_depth_m: float = 0.5
    """Nearer surfaces give no return."""

    max_depth_m: float = 5.0
    """Farther surfaces give no return."""

    forward_m: float = 0.25
    """Length of a forward step."""

    turn_deg: float = 30.0
    """Angle of a turn."""

    tilt_deg: float = 30.0
    """Angle of a look up or down."""

    max_steps: int = Field(default=500, ge=1)
    """Actions after which an episode is cut off."""

    renderer: RendererName = "raster"
    """What draws the images of the embedded simulator: `raster`, `embree` or `gl` (OpenGL, extra
    `gl`). They differ in single pixels at edges: results with different ones are not bit-equal."""

    body: AgentBody = Field(default_factory=AgentBody)
    """The cylinder that moves."""

    noise: NoiseConfig = Field(default_factory=NoiseConfig)
    """Sensor and actuation noise; none by default."""


class HouseEnv(gymnasium.Env[dict[str, Any], Any]):
    """ObjectNav in one scene: Dict observations of posed RGB-D images, `Discrete(6)` actions.

    `terminated` means that the agent stopped, `truncated` that the step limit was reached. The
    reward is 1 for stopping within 0.1 m of a viewpoint of the target, else 0. `info` is empty:
    ground truth is reached through `oracle` alone.

    `reset(options=...)` takes `target` (a category) and `start` (x, y, z, yaw); without them the
    scene's own episodes are taken in order, or drawn from the seed where it has none.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012  # gymnasium's name

    def __init__(
        self,
        scene: Scene | str,
        config: HouseEnvConfig | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Load a scene, given as such or as the spec of one.

        Raises:
            SceneError: The scene cannot be loaded or has nowhere to stand.
        """
        self.config = config or HouseEnvConfig()
        self.scene = _load(scene)
        self.render_mode = render_mode
        size = self.config.width, self.config.height
        self.intrinsics = Intrinsics.from_hfov(*size, self.config.hfov_deg)
        self.surface, self._renderer = self._load_world()
        self.oracle = SceneOracle(self.scene, self.surface, RayCaster(self.scene.mesh), self)
        self.observation_space = _observation_space(*size)
        self.action_space = spaces.Discrete(len(Action))
        self.target = ""
        self.position: NDArray[np.float64] = np.zeros(3)
        self.yaw = 0.0
        self.collided = False
        self._tilt_steps = 0
        self._step_count = 0
        self._next_episode = 0
        self._noise = SensorNoise(self.config.noise, np.random.default_rng(0))
        self._semantic: SemanticFrame | None = None
        self._observation: Observation | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start an episode.

        Raises:
            EpisodeError: The scene lacks the target, or nobody can stand at the start.
        """
        super().reset(seed=seed)
        episode = self._next_from(options or {})
        self.target = self._checked_target(episode.target)
        self.position = self._checked_start(episode.start)
        self.yaw = episode.yaw
        self.collided = False
        self._tilt_steps = 0
        self._step_count = 0
        self._noise = SensorNoise(self.config.noise, self.np_random)
        self._sense()
        return self._as_dict(), {}

    def step(self, action: int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Carry out one action.

        Raises:
            InputError: There is no such action.
            EpisodeError: The environment has not been reset.
        """
        action = self._checked_action(action)
        before = self._world_from_base()
        self.collided = False
        if action is Action.MOVE_FORWARD:
            distance = self._noise.actuated(self.config.forward_m)
            motion = self.surface.move(self.position, self.yaw, distance)
            self.position, self.collided = motion.position, motion.collided
        elif action in (Action.TURN_LEFT, Action.TURN_RIGHT):
            turn = self._noise.actuated(math.radians(self.config.turn_deg))
            signed = turn if action is Action.TURN_LEFT else -turn
            self.yaw = math.remainder(self.yaw + signed, math.tau)
        elif action in (Action.LOOK_UP, Action.LOOK_DOWN):
            change = 1 if action is Action.LOOK_UP else -1
            self._tilt_steps = max(-MAX_TILT_STEPS, min(MAX_TILT_STEPS, self._tilt_steps + change))
        self._noise.moved(before, self._world_from_base())
        self._step_count += 1
        terminated = action is Action.STOP
        truncated = not terminated and self._step_count >= self.config.max_steps
        reward = float(terminated and self.oracle.distance_to_goal() < SUCCESS_RADIUS_M)
        self._sense()
        return self._as_dict(), reward, terminated, truncated, {}

    def drive(self, distance: float, turn: float) -> None:
        """Move as a continuous body does: turn, then go straight on; `look` shows the new image.

        Args:
            distance: Metres along the new heading; a negative one goes back.
            turn: Radians, counter-clockwise.

        Raises:
            EpisodeError: The environment has not been reset.
        """
        self.observe()
        before = self._world_from_base()
        self.yaw = math.remainder(self.yaw + turn, math.tau)
        heading = self.yaw if distance >= 0.0 else self.yaw + math.pi
        motion = self.surface.move(self.position, heading, abs(distance))
        self.position, self.collided = motion.position, motion.collided
        self._noise.moved(before, self._world_from_base())

    def look(self) -> Observation:
        """A new image from where the body stands."""
        self._sense()
        return self.observe()

    def reported_pose(self) -> Pose:
        """`world_from_base` as odometry reports it, with its drift, without a new image."""
        return self._noise.reported(self._world_from_base())

    def render(self) -> NDArray[np.uint8] | None:
        """The last image, in mode `rgb_array`."""
        return self.observe().rgb if self.render_mode == "rgb_array" else None

    def change_to(self, scene: Scene) -> None:
        """Go on in another state of the same building, in the middle of an episode.

        Raises:
            EpisodeError: The agent would stand in something.
        """
        before = self.scene, self.surface, self._renderer
        self.scene = scene
        self.surface, self._renderer = self._load_world()
        if self.surface.snap(self.position, self.config.forward_m) is None:
            self.scene, self.surface, self._renderer = before
            raise EpisodeError(f"{scene.name}: something would stand where the agent is")
        self.oracle.learn(self.scene, self.surface, RayCaster(scene.mesh))
        self._sense()

    def observe(self) -> Observation:
        """The last observation, typed: what an agent of this package takes."""
        if self._observation is None:
            raise EpisodeError("reset the environment before observing it")
        return self._observation

    def semantic_frame(self) -> SemanticFrame:
        """True labels of the last image, for the oracle."""
        if self._semantic is None:
            raise EpisodeError("reset the environment before asking for labels")
        return self._semantic

    def sample_episode(self, rng: np.random.Generator, target: str | None = None) -> SceneEpisode:
        """Draw a target of the scene, unless one is given, and a start far enough from it.

        Targets are drawn from HM3D's six categories, or from MP3D's where the scene has none of
        those, or from whatever it has.

        Raises:
            EpisodeError: The scene has no target that can be reached.
        """
        categories = self.oracle.categories()
        if not categories:
            raise EpisodeError(f"{self.scene.name} has no object that could be a target")
        if target is None:
            usual = (
                [name for name in categories if name in known]
                for known in (HM3D_TARGETS, MP3D_TARGETS)
            )
            candidates = next(filter(None, usual), categories)
            target = candidates[int(rng.integers(len(candidates)))]
        field = self.surface.distance_field(self.oracle.viewpoints(target))
        farthest: tuple[float, NDArray[np.float64]] | None = None
        for _ in range(SAMPLE_TRIES):
            point = self.surface.random_point(rng)
            distance = field.at(point)
            if MIN_SAMPLED_DISTANCE_M <= distance <= MAX_SAMPLED_DISTANCE_M:
                farthest = (distance, point)
                break
            if math.isfinite(distance) and (farthest is None or distance > farthest[0]):
                farthest = (distance, point)
        if farthest is None:
            raise EpisodeError(f"no start in {self.scene.name} from which {target} can be reached")
        x, y, z = (float(v) for v in farthest[1])
        return SceneEpisode(target, (x, y, z), float(rng.uniform(-math.pi, math.pi)))

    def episode(
        self,
        target: str | None = None,
        start: tuple[float, float, float, float] | None = None,
        seed: int = 0,
    ) -> SceneEpisode:
        """The episode that a caller asks for; what is left open comes from the scene or the seed.

        Args:
            target: Category; by default that of the scene's first episode, or drawn.
            start: (x, y, z, yaw); by default that of the scene's first episode with the target,
                or drawn.
            seed: Seeds what is drawn.

        Raises:
            EpisodeError: The scene lacks the target, or has none that can be reached.
        """
        name = None if target is None else self._checked_target(target)
        own = [e for e in self.scene.episodes if name in (None, canonical(e.target))]
        if name is not None and start is not None:
            base = SceneEpisode(name, (0.0, 0.0, 0.0), 0.0)
        else:
            base = own[0] if own else self.sample_episode(np.random.default_rng(seed), name)
        if start is None:
            return base
        x, y, z, yaw = (float(v) for v in start)
        return SceneEpisode(base.target, (x, y, z), yaw)

    def _load_world(self) -> tuple[Surface, CameraRenderer]:
        """Where the agent can be, and what its camera sees; another simulator brings its own."""
        surface = NavigableSurface.build(self.scene.mesh, self.config.body, self.scene.floors)
        return surface, make_renderer(self.config.renderer, self.scene.mesh)

    def _next_from(self, options: dict[str, Any]) -> SceneEpisode:
        """The episode of a reset: as the options say, else the scene's own in turn."""
        target, start = options.get("target"), options.get("start")
        if target is None and start is None and self.scene.episodes:
            self._next_episode += 1
            return self.scene.episodes[(self._next_episode - 1) % len(self.scene.episodes)]
        return self.episode(target, start, int(self.np_random.integers(2**31)))

    def _checked_action(self, action: int) -> Action:
        if self._observation is None:
            raise EpisodeError("reset the environment before stepping it")
        if not self.action_space.contains(action):
            raise InputError(f"actions are the integers 0 to {len(Action) - 1}, not {action!r}")
        return Action(action)

    def _checked_target(self, name: str) -> str:
        target = canonical(name)
        if target in STRUCTURE_CATEGORIES | {"unknown"} or not len(self.oracle.viewpoints(target)):
            known = self.oracle.categories()
            has = ", ".join(readable(category) for category in known) or "nothing that could be one"
            raise EpisodeError(
                f"{self.scene.name} has no reachable {readable(target)}; it has {has}"
            )
        return target

    def _checked_start(self, start: tuple[float, float, float]) -> NDArray[np.float64]:
        point = np.asarray(start, dtype=np.float64)
        if not np.isfinite(point).all():
            raise EpisodeError(f"the start {start} holds NaN or infinity")
        snapped = self.surface.snap(point, START_TOLERANCE_M)
        if snapped is None:
            nearest = self.surface.snap(point, math.inf)
            hint = (
                ""
                if nearest is None
                else "; the nearest free place is " + ", ".join(f"{v:.2f}" for v in nearest)
            )
            place = ", ".join(f"{v:.2f}" for v in point)
            raise EpisodeError(
                f"nobody can stand at {place} in {self.scene.name} (wall, furniture or no floor)"
                f"{hint}"
            )
        return snapped

    def _sense(self) -> None:
        """Render what the camera sees and report the pose."""
        config = self.config
        world_from_base = self._world_from_base()
        world_from_camera = world_from_base @ self._base_from_camera()
        frame = self._renderer.render(world_from_camera, self.intrinsics)
        depth = self._noise.measured(frame.depth)
        reported = self._noise.reported(world_from_base)
        self._semantic = SemanticFrame(
            frame.instance_ids,
            self.scene.mesh.instances,
            frame.depth,
            world_from_camera,
            self.intrinsics,
        )
        self._observation = Observation(
            rgb=frame.rgb,
            depth=clip_range(depth, config.min_depth_m, config.max_depth_m),
            world_from_camera=reported @ self._base_from_camera(),
            world_from_base=reported,
            intrinsics=self.intrinsics,
            collided=self.collided,
            step=self._step_count,
            timestamp_s=float(self._step_count),
        )

    def _world_from_base(self) -> Pose:
        """The true pose of the agent's foot point."""
        return Pose.from_yaw(self.yaw, self.position)

    def _base_from_camera(self) -> Pose:
        """The tilted optical frame above the foot point."""
        pitch = math.radians(self.config.tilt_deg) * self._tilt_steps
        up = Rotation.from_euler("y", -pitch).as_matrix()
        tilted = Pose.from_rotation(up, (0.0, 0.0, self.config.camera_height_m))
        return tilted @ BODY_FROM_OPTICAL

    def _as_dict(self) -> dict[str, Any]:
        observation = self.observe()
        return {
            "rgb": observation.rgb,
            "depth": observation.depth,
            "world_from_camera": observation.world_from_camera.matrix.copy(),
            "world_from_base": observation.world_from_base.matrix.copy(),
            "collided": int(observation.collided),
            "step": np.array([observation.step], dtype=np.int64),
            "timestamp_s": np.array([observation.timestamp_s]),
        }


def _observation_space(width: int, height: int) -> spaces.Dict:
    pose = spaces.Box(-np.inf, np.inf, (4, 4), np.float64)
    return spaces.Dict(
        {
            "rgb": spaces.Box(0, 255, (height, width, 3), np.uint8),
            "depth": spaces.Box(0.0, np.inf, (height, width), np.float32),
            "world_from_camera": pose,
            "world_from_base": pose,
            "collided": spaces.Discrete(2),
            "step": spaces.Box(0, np.iinfo(np.int64).max, (1,), np.int64),
            "timestamp_s": spaces.Box(0.0, np.inf, (1,), np.float64),
        }
    )


def _load(scene: Scene | str) -> Scene:
    if isinstance(scene, Scene):
        return scene
    from toponav.scenes.loading import load_scene

    return load_scene(scene)
