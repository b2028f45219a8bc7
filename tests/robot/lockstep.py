"""The whole of a robot's search without ROS and without waiting: one thread, one made-up clock."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

from toponav.navigator import Navigator
from toponav.reasoning.prior import PriorReasoner
from toponav.robot.config import RobotConfig, navigator_config
from toponav.robot.frames import COLOR, DEPTH, LABELS, FrameReader
from toponav.robot.labels import LabelImageDetector
from toponav.robot.obstacle_guard import ObstacleGuard
from toponav.robot.pilot import Pilot
from toponav.robot.pose_continuity import PoseContinuity
from toponav.robot.search import Search, SearchTiming, Status
from toponav.robot.senses import Senses
from toponav.robot.sim_base import SimBase, SimBaseConfig
from toponav.robot.sim_env import RobotEnv
from toponav.robot.sim_faults import FaultConfig, Faults
from toponav.robot.watchdog import Watchdog
from toponav.scenes.loading import load_scene

TICK_S = 0.05


def image(encoding: str, pixels: np.ndarray) -> SimpleNamespace:
    """A sensor_msgs/Image, as far as it is read."""
    height, width = pixels.shape[:2]
    data = np.ascontiguousarray(pixels).tobytes()
    step = pixels.strides[0]
    return SimpleNamespace(encoding=encoding, height=height, width=width, step=step, data=data)


class Lockstep:
    """A simulated robot and its search, ticked together."""

    def __init__(
        self,
        house: str = "generated:6",
        target: str | None = None,
        robot: RobotConfig | None = None,
        faults: FaultConfig | None = None,
        start: tuple[float, float, float, float] | None = None,
    ) -> None:
        robot = robot or RobotConfig()
        self.env = RobotEnv(load_scene(house), robot, (160, 120))
        episode = self.env.episode(target)
        self.target = episode.target
        start = start or (*episode.start, episode.yaw)
        self.env.reset(seed=0, options={"target": episode.target, "start": start})
        self.base = SimBase(self.env, SimBaseConfig())
        self.faults = Faults(faults or FaultConfig(), np.random.default_rng(0))
        self.now_s = 1000.0
        labels = LabelImageDetector()
        self.reader = FrameReader(robot.camera, labels)
        self.watchdog = Watchdog(robot.watchdog)
        guard = ObstacleGuard(robot.guard, robot.footprint, robot.motion)
        motion = robot.motion
        continuity = PoseContinuity(motion.max_speed, motion.max_turn_rate)
        self.senses = Senses(self.reader, continuity, self.watchdog, guard, robot.camera.slop_s)
        self.pilot = Pilot(motion, self.watchdog, guard)
        self.agent = Navigator(labels, PriorReasoner(), navigator_config(robot))
        timing = SearchTiming(math.radians(robot.turn_deg), motion.settle_s)
        self.search = Search(self.agent, self.pilot, self.senses, timing, lambda: self.now_s)
        self.search.watchers.append(
            lambda instant, intent: guard.consult(self.agent.knowledge.semantic_map.view().grid)
        )
        camera = self.env.intrinsics
        self.reader.take_info(
            SimpleNamespace(width=camera.width, height=camera.height, k=camera.matrix.ravel())
        )
        names = [instance.category for instance in self.env.scene.mesh.instances]
        self.reader.take_names(SimpleNamespace(data=str(names).replace("'", '"')))
        self._late: list[tuple[float, str, float, SimpleNamespace]] = []
        self._ticks = 0

    def tick(self) -> None:
        """Twentieths of a second: move, sense, think, command."""
        self.now_s += TICK_S
        self._ticks += 1
        self.base.advance(self.now_s)
        if self.base.twist.speed or self.base.twist.turn_rate:
            self.faults.moves(self.now_s, self.base.twist.speed)
        pose = self.faults.reported(self.base.pose)
        self.senses.pose_came(self.now_s, pose, self.now_s)
        if self._ticks % 3 == 0 and not self.faults.is_silent(self.now_s):
            self._look()
        while self._late and self._late[0][0] <= self.now_s:
            _, kind, stamp_s, message = self._late.pop(0)
            self.senses.image_came(kind, stamp_s, message, self.now_s, self.now_s)
        self.search.round()
        slam = self.senses.slam_pose
        self.base.obey(self.pilot.tick(self.senses.pose, slam, self.now_s), self.now_s)

    def run(self, seconds: float) -> None:
        """Until the search is over, or the time is up."""
        for _ in range(round(seconds / TICK_S)):
            if self.search.status is not Status.SEARCHING:
                return
            self.tick()

    def run_until_speed(self, speed: float, seconds: float = 120.0) -> None:
        """Until the robot drives so fast."""
        for _ in range(round(seconds / TICK_S)):
            self.tick()
            if self.base.twist.speed >= speed:
                return
        raise AssertionError(f"never at {speed} m/s")

    def _look(self) -> None:
        seen = self.env.look()
        ids = self.env.semantic_frame().instance_ids.astype(np.int32)
        taken = {
            DEPTH: image("16UC1", np.round(seen.depth * 1000.0).astype(np.uint16)),
            COLOR: image("rgb8", seen.rgb),
            LABELS: image("32SC1", ids),
        }
        for kind, message in taken.items():
            if not self.faults.loses():
                due_s = self.now_s + self.faults.config.latency_s
                self._late.append((due_s, kind, self.now_s, message))
