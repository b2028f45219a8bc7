"""`toponav bench habitat` and `habitat-lab`: this package and Habitat side by side."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from toponav.cli.options import JsonFlag


@dataclass(frozen=True)
class Habitat:
    """The embedded simulator against habitat-sim, in a scene that both load."""

    scene: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="SCENE")]
    """A .glb of a Habitat dataset, such as one that scenes export --format habitat wrote."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    poses: int = 50
    """Views whose images are compared and timed."""

    pairs: int = 100
    """Pairs of points between which geodesic distances are compared."""

    actions: int = 500
    """Actions of a random walk in both."""

    seed: int = 0
    """Draws places and actions."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Compare and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.envs.simulator import HouseEnvConfig
        from toponav.evaluation.bench_habitat import bench_habitat
        from toponav.scenes.loading import load_scene

        width, height = image_size(self.camera)
        # A random walk may not be cut off by the step limit.
        config = HouseEnvConfig(width=width, height=height, max_steps=self.actions + 1)
        scene = load_scene(self.scene)
        figures = bench_habitat(scene, config, self.poses, self.pairs, self.actions, self.seed)
        Output(self.json).result(_habitat_line(figures, self.actions), figures)


def _habitat_line(figures: dict[str, Any], actions: int) -> str:
    fps = figures["fps"]
    return (
        f"{figures['scene']}: depth differs by {1e3 * figures['depth_m']:.3f} mm (median of the "
        f"worst view), ids equal on {100 * figures['ids']:.2f} % (worst view), RGB by "
        f"{figures['rgb']:.1f} of 255; geodesics agree for {100 * figures['geodesic_ok']:.0f} % "
        f"(largest difference {figures['geodesic_m']:.2f} m); together for {figures['walk']} of "
        f"{actions} actions (within {100 * figures['walk_m']:.2f} cm, collisions equal on "
        f"{100 * figures['collisions']:.1f} %); frames/s {fps['embedded']:.1f} embedded, "
        f"{fps['habitat']:.1f} Habitat"
    )


@dataclass(frozen=True)
class HabitatLab:
    """An agent inside habitat-lab's own ObjectNav task: its scores there and by our metrics."""

    episodes_file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """An ObjectNav episode file."""

    data: Path = Path("data")
    """Habitat's data folder."""

    episodes: int = 20
    """How many, from the first."""

    method: str = "toponav"
    """Which agent."""

    camera: str = "640x480"
    """Image size, WIDTHxHEIGHT."""

    backend: Literal["habitat", "embedded"] = "habitat"
    """What simulates the same actions again, to be scored by our metrics."""

    json: JsonFlag = False
    """Print the figures as one JSON object on stdout."""

    def run(self) -> None:
        """Run in habitat-lab, score here, and print."""
        from toponav.cli.console import Output
        from toponav.cli.options import image_size
        from toponav.envs.simulator import HouseEnvConfig
        from toponav.evaluation.run_config import run_config
        from toponav.habitat.lab_comparison import compare_with_habitat_lab, mean_scores

        output = Output(self.json)
        width, height = image_size(self.camera)
        env = HouseEnvConfig(width=width, height=height)
        config = run_config("default", self.method, env=env)
        config = config.model_copy(update={"backend": self.backend})
        compared = compare_with_habitat_lab(self.episodes_file, self.data, self.episodes, config)
        for one in compared:
            output.say(
                f"{one.lab.scene} #{one.lab.index}: success {one.lab.success:d} "
                f"SPL {one.lab.spl:.4f} DTG {one.lab.distance_to_goal:.4f}, here "
                f"{one.ours.success['0.1']:d} {one.ours.spl:.4f} {one.distance_to_goal:.4f}"
            )
        figures = mean_scores(compared)
        lab, ours = figures["habitat_lab"], figures["toponav"]
        output.result(
            f"{figures['episodes']} episodes: habitat-lab SR {100 * lab['success']:.1f} % SPL "
            f"{lab['spl']:.4f} DTG {lab['dtg']:.4f}; toponav SR {100 * ours['success']:.1f} % SPL "
            f"{ours['spl']:.4f} DTG {ours['dtg']:.4f}; largest difference in an episode "
            f"{figures['largest_difference']:.1e}",
            figures,
        )
