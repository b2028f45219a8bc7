"""`toponav ros2` and `toponav sim-robot`: a search on a ROS 2 robot, and a robot to try it on."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from toponav.cli.options import JsonFlag, OffFlag

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from toponav.knowledge import Knowledge
    from toponav.robot.ros2_node import SearchNode
    from toponav.viz.topdown import TopDownPicture


@dataclass(frozen=True)
class Ros2:
    """Search on a ROS 2 robot with an RGB-D camera; needs the extra `ros2`."""

    target: str | None = None
    """What to find; without it the node waits for goals on toponav/goal until it is interrupted."""

    robot: str = "generic"
    """generic, turtlebot, go2_d435i, or a YAML file of topics, camera, body and limits."""

    drive: Literal["cmd_vel", "goal_pose"] | None = None
    """Send velocities, or goals for Nav2; by default as the robot's file says."""

    detector: str = "labels"
    """Finds objects in the images: onnx:MODEL.onnx, or labels for images that another node
    publishes."""

    reasoner: Literal["prior", "openai"] = "prior"
    """What plays the VLM: offline, or a model behind any OpenAI-compatible server."""

    model: str | None = None
    """Model of the reasoner openai; by default gpt-4o."""

    base_url: str | None = None
    """Server of the reasoner openai; the key comes from OPENAI_API_KEY alone."""

    memory: Path | None = None
    """File of what is known of the building: read if it exists, and written every few seconds."""

    record: Path | None = None
    """Write every image that the agent looks at, and all poses, as a bag: toponav map makes the
    same map of it."""

    out: Path | None = None
    """Folder for the map's clouds at the end, and a top-down picture with path and memory."""

    timeout_s: float = 900.0
    """Give up after so many seconds."""

    dry_run: OffFlag = False
    """Do everything but send commands."""

    managed: OffFlag = False
    """Wait for a lifecycle manager to configure and to activate the node."""

    show_robot: OffFlag = False
    """Print every value of --robot, as a YAML file to start from, and do nothing else."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Search until the agent stops, the time is up or the search fails."""
        from toponav.cli.console import Output
        from toponav.errors import TopoNavError
        from toponav.knowledge import RecallingAgent
        from toponav.robot.assembly import AgentParts, robot_task
        from toponav.robot.bag_writer import BagWriter
        from toponav.robot.config import robot_config, robot_yaml
        from toponav.robot.ros2_record import SearchRecorder
        from toponav.robot.ros2_run import RunOptions, run_node
        from toponav.viz.topdown import save_topdown

        output = Output(self.json)
        changes: dict[str, Any] = {"dry_run": True} if self.dry_run else {}
        if self.drive is not None:
            changes["drive"] = self.drive
        robot = robot_config(self.robot, changes)
        if self.show_robot:
            output.result(robot_yaml(robot).rstrip(), robot.model_dump(mode="json"))
            return
        parts = AgentParts(self.detector, self.reasoner, self.model, self.base_url, self.memory)
        task = robot_task(parts, robot)
        with ExitStack() as stack:
            trail = Trail()
            watchers: list[Callable[[SearchNode], object]] = [trail.follow]
            if self.record is not None:
                bag = stack.enter_context(BagWriter(self.record))
                watchers.append(partial(SearchRecorder, bag=bag, robot=task.robot))
            options = RunOptions(self.memory, self.out, watchers, self.managed)
            status = run_node(task, self.target, self.timeout_s, options, output.say)
        if self.out is not None and isinstance(task.agent, RecallingAgent):
            picture = trail.picture(task.agent.knowledge, status["goal"], status["status"])
            save_topdown(picture, self.out / "topdown.png")
        if self.target is not None and status["status"] != "done":
            raise TopoNavError(f"no {self.target} found: {status['reason'] or 'the time is up'}")
        output.result(_ros2_line(status), status)


class Trail:
    """Where the robot was when the agent looked."""

    def __init__(self) -> None:
        """Nowhere yet."""
        self._positions: list[NDArray[np.float64]] = []

    def follow(self, node: SearchNode) -> None:
        """Follow a node's search."""
        node.search.watchers.append(
            lambda instant, _: self._positions.append(instant.world_from_base.translation)
        )

    def picture(self, knowledge: Knowledge, goal: str, status: str) -> TopDownPicture:
        """What is known of the building, and the way through it."""
        import numpy as np

        from toponav.viz.topdown import TopDownPicture

        positions = np.array(self._positions, np.float64).reshape(-1, 3)
        title = f"{goal}: {status}"
        view = knowledge.semantic_map.view()
        return TopDownPicture(view, positions, knowledge.memory, goal, title)


def _ros2_line(status: dict[str, Any]) -> str:
    found = status["found"]
    where = "" if found is None else "at {:.2f}, {:.2f}, {:.2f} m; ".format(*found)
    process = status["process"]
    lines = [
        f"{status['status']}: {status['goal']} {where}{status['steps']} steps, "
        f"{status['seconds']:.0f} s",
        f"processor {100.0 * process['cpu_s'] / process['wall_s']:.0f} % of a core, "
        f"{process['peak_mb']:.0f} MB",
    ]
    lines += [
        f"{name}: median {taken['median_ms']:.0f} ms, 99 % {taken['p99_ms']:.0f} ms, "
        f"longest {taken['max_ms']:.0f} ms ({taken['count']})"
        for name, taken in status["timings"].items()
    ]
    return "\n".join(lines)


@dataclass(frozen=True)
class Record:
    """Record the camera and the pose of a ROS 2 robot as a bag; needs the extra `ros2`."""

    bag: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="BAG")]
    """Folder of the new bag (rosbag2, MCAP); an older bag of this name is replaced."""

    robot: str = "generic"
    """generic, turtlebot, go2_d435i, or a YAML file."""

    seconds: float = 3600.0
    """How long at most."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Record until the time is up or the process is interrupted."""
        from toponav.cli.console import Output
        from toponav.errors import TopoNavError
        from toponav.robot.config import robot_config
        from toponav.robot.ros2_record import record

        output = Output(self.json)
        messages = record(robot_config(self.robot), self.bag, self.seconds, output.say)
        if not messages:
            raise TopoNavError(f"nothing came on the topics of {self.robot}: {self.bag} is empty")
        data = {"bag": str(self.bag), "messages": messages}
        output.result(f"{messages} messages in {self.bag}", data)


@dataclass(frozen=True)
class FaultOptions:
    """What goes wrong with the robot's sensors; times are seconds after its first motion."""

    drop: float = 0.0
    """Share of images that are lost."""

    latency_s: float = 0.0
    """Images come so much later than they were taken."""

    jump_at_s: float | None = None
    """When the pose jumps by 0.3 m."""

    silent_at_s: float | None = None
    """When the camera falls silent for 3 s."""


@dataclass(frozen=True)
class SimRobotCommand:
    """Play a ROS 2 robot with an RGB-D camera in a scene; needs the extra `ros2`."""

    house: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="HOUSE")] = "generated:0"
    """House file, mesh scene, or generated:SEED."""

    target: str | None = None
    """What the distance at the end is measured to, and the start is drawn for."""

    start: str | None = None
    """Start pose x,y,z,yaw in metres and radians; by default that of the scene's episode."""

    robot: str = "generic"
    """generic, turtlebot, go2_d435i, or a YAML file."""

    seconds: float = 900.0
    """How long to play."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    camera_hz: float = 15.0
    """Images a second."""

    drift: OffFlag = False
    """Let the pose drift by 1 cm and half a degree a metre, and the depth be noisy."""

    faults: Annotated[FaultOptions, tyro.conf.arg(name="")] = field(default_factory=FaultOptions)
    """What goes wrong."""

    trace: Path | None = None
    """Write where the body was, 50 times a second, as CSV."""

    seed: int = 0
    """Of noise and lost images."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Publish and obey until the time is up or the process is interrupted."""
        from dataclasses import asdict

        from toponav.cli.console import Output
        from toponav.cli.options import image_size, start_pose
        from toponav.config import parse_config
        from toponav.envs.simulator.sensors import NoiseConfig
        from toponav.robot.config import robot_config
        from toponav.robot.ros2_import import import_ros
        from toponav.robot.sim_env import RobotEnv
        from toponav.robot.sim_robot import SimRobot, SimRobotConfig
        from toponav.robot.sim_run import play, sim_result
        from toponav.scenes.loading import load_scene

        output = Output(self.json)
        import_ros("rclpy")
        robot = robot_config(self.robot)
        given = {key: value for key, value in asdict(self.faults).items() if value is not None}
        motion = robot.motion
        speeds = {"goal_speed": motion.max_speed, "goal_turn_rate": motion.max_turn_rate}
        values = {"camera_hz": self.camera_hz, "faults": given, "base": speeds}
        config = parse_config(SimRobotConfig, values, "the command line")
        noise = NoiseConfig(depth=True, drift_per_m=0.01, drift_yaw_per_m=0.01)
        env = RobotEnv(
            load_scene(self.house), robot, image_size(self.camera), noise if self.drift else None
        )
        start = None if self.start is None else start_pose(self.start)
        episode = env.episode(self.target, start, self.seed)
        env.reset(
            seed=self.seed,
            options={"target": episode.target, "start": (*episode.start, episode.yaw)},
        )
        line = f"{env.scene.name}: a robot with a {episode.target} to find"
        robot_node = play(lambda: SimRobot(env, robot, config, self.seed), self.seconds, line)
        data = sim_result(env, robot_node, self.trace)
        output.result(
            f"{data['distance_to_goal']:.2f} m from the {episode.target}, travelled "
            f"{data['travelled']:.1f} m, {data['bumps']} bumps (fastest {data['bump_speed']:.2f} "
            f"m/s), {data['frames']} frames",
            data,
        )
