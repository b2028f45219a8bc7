"""Agents of this package inside habitat-lab: `habitat.Env`, `habitat.Benchmark`, the challenges.

`ChallengeAgent` has habitat-lab's Agent interface and knows what the ObjectNav task gives it and
nothing else: RGB, depth, GPS, compass and the goal's number. Habitat itself is not imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from toponav.categories import HM3D_TARGETS, canonical
from toponav.envs.simulator import HouseEnvConfig
from toponav.errors import InputError, ObservationError
from toponav.evaluation.run_config import RunConfig, run_config
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.methods import AgentContext, methods
from toponav.perception import DetectorContext, check_detector, make_detector
from toponav.perception.base import Detector
from toponav.reasoning import ReasonerContext, reasoners
from toponav.types import Action, Agent, Instance, Observation, SemanticFrame

COLLISION_M2 = 1e-5
"""habitat-sim's rule: a step whose squared length falls short by more than this collided."""

Annotations = Callable[[], Sequence[Instance]]
"""The instances of the scene that the running episode is in, by semantic id."""


class ChallengeAgent:
    """Any method of this package as a habitat-lab agent.

    `reset()` begins an episode, and `act(observations)` answers with habitat-lab's action. The keys
    that are read are `rgb` (H, W, 3) uint8, `depth` (H, W, 1) float32, `gps` (2,) or (3,) float32,
    `compass` (1,) float32 and `objectgoal` (1,), as habitat-lab's ObjectNav gives them. With a GPS
    of two dimensions the agent takes the whole episode to happen on one floor.
    """

    def __init__(
        self,
        detector: str | Detector,
        config: RunConfig | None = None,
        categories: Sequence[str] = HM3D_TARGETS,
        *,
        normalized_depth: bool = True,
        annotations: Annotations | None = None,
    ) -> None:
        """Choose method and parts.

        Args:
            detector: A registered detector's name, or a detector.
            config: Method, reasoner and every parameter; its `env` is the task's camera, range and
                motion. The preset `default` of TopoNav without it.
            categories: Names of the goals by their number in `objectgoal`.
            normalized_depth: Whether the task gives depth as 0..1 (habitat-lab's default) or in
                metres.
            annotations: For detectors that stand for real ones: the scene's instances, by the ids
                of the task's `semantic` observation.

        Raises:
            InputError: Unknown method, reasoner or detector.
        """
        self._config = config or run_config("default")
        self._categories = tuple(canonical(name) for name in categories)
        self._normalized_depth = normalized_depth
        self._sight = _SemanticSensor(annotations)
        self._detector = detector
        self._episode = -1
        self._agent: Agent | None = None
        self._track = _Track(self._config.env)
        methods.get(self._config.method)
        reasoners.get(self._config.reasoner)
        if isinstance(detector, str):
            check_detector(detector)

    def reset(self) -> None:
        """Begin the next episode; its goal is in its first observations."""
        self.close()
        self._episode += 1
        self._track = _Track(self._config.env)

    def act(self, observations: Mapping[str, Any]) -> dict[str, int]:
        """The next action, as `habitat.Env.step` takes it.

        Raises:
            ObservationError: An observation is missing or of the wrong kind.
            InputError: The goal's number names no category.
        """
        observation = self._track.observe(observations, self._normalized_depth)
        self._sight.show(observations, observation)
        if self._agent is None:
            self._agent = self._make()
            self._agent.reset(self._goal(observations))
        action = self._agent.act(observation)
        self._track.acted(action)
        return {"action": int(action)}

    def close(self) -> None:
        """End the running episode."""
        if self._agent is not None:
            self._agent.close()
        self._agent = None

    def _make(self) -> Agent:
        config = self._config
        seed = config.seed * 1_000_003 + max(self._episode, 0)
        detector = self._detector
        if isinstance(detector, str):
            context = DetectorContext(config.perception, self._sight, seed)
            detector = make_detector(detector, context)
        reasoner = reasoners.get(config.reasoner)(
            ReasonerContext(config=config.reasoning, seed=seed)
        )
        return methods.get(config.method)(
            AgentContext(detector=detector, reasoner=reasoner, config=config.navigator, seed=seed)
        )

    def _goal(self, observations: Mapping[str, Any]) -> str:
        number = int(_array(observations, "objectgoal").reshape(-1)[0])
        if not 0 <= number < len(self._categories):
            raise InputError(
                f"objectgoal {number} is none of the {len(self._categories)} categories: give the "
                "dataset's own as ChallengeAgent(categories=...)"
            )
        return self._categories[number]


class _Track:
    """Turns one episode's observations into this project's: x ahead of the start, z up."""

    def __init__(self, config: HouseEnvConfig) -> None:
        self._config = config
        self._step = 0
        self._tilt_rad = 0.0
        self._last: tuple[Action, NDArray[np.float64]] | None = None
        self._here = np.zeros(3)

    def observe(self, observations: Mapping[str, Any], normalized: bool) -> Observation:
        rgb = np.ascontiguousarray(_array(observations, "rgb")[..., :3], np.uint8)
        height, width = rgb.shape[:2]
        self._here = _position(_array(observations, "gps").reshape(-1))
        yaw = float(_array(observations, "compass").reshape(-1)[0])
        world_from_base = Pose.from_yaw(yaw, self._here)
        return Observation(
            rgb=rgb,
            depth=self._depth(_array(observations, "depth"), (height, width), normalized),
            world_from_camera=world_from_base @ self._base_from_camera(),
            world_from_base=world_from_base,
            intrinsics=Intrinsics.from_hfov(width, height, self._config.hfov_deg),
            collided=self._collided(),
            step=self._step,
            timestamp_s=float(self._step),
        )

    def acted(self, action: Action) -> None:
        """Remember what was done, and from where."""
        self._step += 1
        self._last = (action, self._here)
        tilt = {Action.LOOK_UP: 1.0, Action.LOOK_DOWN: -1.0}.get(action, 0.0)
        self._tilt_rad += tilt * math.radians(self._config.tilt_deg)

    def _depth(
        self, depth: NDArray[Any], shape: tuple[int, int], normalized: bool
    ) -> NDArray[np.float32]:
        """Metres; both ends of the range stand for no return, since habitat-lab clips to them."""
        nearest, farthest = self._config.min_depth_m, self._config.max_depth_m
        metres = depth.astype(np.float32).reshape(shape)
        if normalized:
            metres = np.float32(nearest) + metres * np.float32(farthest - nearest)
        inside = (metres > nearest) & (metres < farthest)
        return np.where(inside, metres, np.float32(0.0)).astype(np.float32)

    def _collided(self) -> bool:
        if self._last is None or self._last[0] is not Action.MOVE_FORWARD:
            return False
        moved = float(np.sum((self._here - self._last[1])[:2] ** 2))
        return moved + COLLISION_M2 < self._config.forward_m**2

    def _base_from_camera(self) -> Pose:
        up = Rotation.from_euler("y", -self._tilt_rad).as_matrix()
        return Pose.from_rotation(up, (0.0, 0.0, self._config.camera_height_m)) @ BODY_FROM_OPTICAL


def _position(gps: NDArray[Any]) -> NDArray[np.float64]:
    """Where the agent is, from a GPS of two (ahead, right) or three (right, up, back) numbers."""
    if len(gps) == 2:
        return np.array([gps[0], -gps[1], 0.0])
    return np.array([-gps[2], -gps[0], gps[1]])


class _SemanticSensor:
    """The task's semantic sensor as a source of true labels."""

    def __init__(self, annotations: Annotations | None) -> None:
        self._annotations = annotations
        self._frame: SemanticFrame | None = None

    def show(self, observations: Mapping[str, Any], observation: Observation) -> None:
        """Keep the labels of the newest image, if the task gives any."""
        self._frame = None
        if self._annotations is None or "semantic" not in observations:
            return
        instances = tuple(self._annotations())
        ids = _array(observations, "semantic").astype(np.int32).reshape(observation.depth.shape)
        self._frame = SemanticFrame(
            np.where(ids < len(instances), ids, -1).astype(np.int32),
            instances,
            observation.depth,
            observation.world_from_camera,
            observation.intrinsics,
        )

    def semantic_frame(self) -> SemanticFrame:
        """Labels of the image last observed."""
        if self._frame is None:
            raise ObservationError(
                "this detector needs true labels: give the task a semantic sensor and the agent "
                "its annotations, or choose another detector"
            )
        return self._frame


def _array(observations: Mapping[str, Any], name: str) -> NDArray[Any]:
    if name not in observations:
        raise ObservationError(f"the task gives no {name!r}; ObjectNav's sensors do")
    return np.asarray(observations[name])
