"""`toponav map`: the map and the memory of a recording of posed RGB-D images."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from toponav.cli.options import JsonFlag, WorldOption


@dataclass(frozen=True)
class Map:
    """Build the map and the memory of a recording of posed RGB-D images.

    Writes every cloud as PLY, the memory, and top-down pictures of the map and of its colours.
    """

    recording: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RECORDING")]
    """Folder of frame-*.color, .depth and .pose files (the 7-Scenes layout), folder of the TUM
    RGB-D benchmark, or a bag: .bag of ROS 1, .mcap or the folder of a rosbag2 (extra `bags`)."""

    robot: str = "generic"
    """For a bag: generic, turtlebot, go2_d435i, or a YAML file of its topics and camera."""

    world: WorldOption = None
    """Which way the world of the poses points; by default what recording.json says, else told
    from the images."""

    detector: str | None = None
    """Finds objects in the images: onnx:MODEL.onnx. Without one the map holds no objects."""

    out: Path = Path("runs/map")
    """Folder for the results."""

    json: JsonFlag = False
    """Print the counts as one JSON object on stdout."""

    def run(self) -> None:
        """Integrate all frames and write what came of it."""
        from toponav.cli.console import Output
        from toponav.cli.options import fresh_folder
        from toponav.config import NavigatorConfig
        from toponav.envs.recording import open_recording
        from toponav.evaluation.mapping_run import Observations, map_recording, write_clouds
        from toponav.memory.serialization import save_memory
        from toponav.perception import DetectorContext, PerceptionConfig, make_detector
        from toponav.perception.base import Detector
        from toponav.robot.bag_recording import is_bag, open_bag
        from toponav.robot.config import navigator_config, robot_config
        from toponav.viz.topdown import TopDownPicture, save_topdown
        from toponav.viz.topdown_colors import save_topdown_colors

        output = Output(self.json)
        detector: Detector | None = None
        config: NavigatorConfig | None = None
        recording: Observations
        if is_bag(self.recording):
            robot = robot_config(self.robot)
            recording = bag = open_bag(self.recording, robot)
            detector, config = bag.labels, navigator_config(robot)
        else:
            recording = open_recording(self.recording, self.world)
        if self.detector is not None:
            detector = make_detector(self.detector, DetectorContext(PerceptionConfig()))
        folder = fresh_folder(self.out)

        def report(done: int, total: int) -> None:
            if done % 20 == 0 or done == total:
                output.say(f"{done} of {total} frames")

        run = map_recording(recording, detector, config, report)
        write_clouds(run.view, folder)
        save_memory(run.memory, folder / "memory.json")
        title = f"{self.recording.resolve().name}: {len(run.trajectory)} frames"
        picture = TopDownPicture(run.view, run.trajectory, run.memory, title=title)
        save_topdown(picture, folder / "topdown.png")
        save_topdown_colors(run.view, folder / "colors.png")
        counts = {
            "frames": len(run.trajectory),
            "scene": len(run.view.scene),
            "navigable": len(run.view.navigable),
            "obstacles": len(run.view.obstacles),
            "frontiers": len(run.view.frontiers),
            "objects": {name: len(cloud) for name, cloud in run.view.objects.items()},
            "nodes": len(run.memory.nodes),
            "floor_z": run.view.floor_z,
            "map_bytes": run.map_bytes,
        }
        line = (
            f"M_scene {counts['scene']}, M_nav {counts['navigable']}, M_obs {counts['obstacles']}, "
            f"M_fro {counts['frontiers']} points, {counts['nodes']} nodes; written to {folder}"
        )
        output.result(line, {**counts, "out": str(folder)})
