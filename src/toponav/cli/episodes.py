"""`toponav episodes`: list and check an ObjectNav episode file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from toponav.cli.options import JsonFlag

if TYPE_CHECKING:
    from toponav.datasets import DatasetReport, ObjectNavEpisode


@dataclass(frozen=True)
class Episodes:
    """List the episodes of an ObjectNav file in Habitat's format, and check its numbers."""

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """A split's .json.gz, with the folder `content` beside it, or one scene's."""

    scene: str | None = None
    """List this scene's episodes only."""

    limit: int | None = None
    """List so many at most."""

    data: Path = Path("data")
    """Folder that holds `scene_datasets`; scenes that are missing there are named."""

    json: JsonFlag = False
    """Print episodes and report as one JSON object on stdout."""

    def run(self) -> None:
        """Read, list and check."""
        from dataclasses import asdict

        from toponav.cli.console import Output
        from toponav.datasets import check_objectnav, load_objectnav
        from toponav.errors import InputError, TopoNavError

        dataset = load_objectnav(self.file)
        listed = [e for e in dataset.episodes if self.scene in (None, e.scene)]
        if not listed:
            scenes = ", ".join(sorted({episode.scene for episode in dataset.episodes}))
            raise InputError(f"{self.file}: no scene {self.scene!r}; it has {scenes}")
        report = check_objectnav(dataset)
        lines = [*map(_line, listed[: self.limit]), *_summary(report), *self._missing(listed)]
        Output(self.json).result(
            "\n".join(lines),
            {"report": asdict(report), "episodes": [_record(e) for e in listed[: self.limit]]},
        )
        if report.problems:
            raise TopoNavError(f"{self.file}: {len(report.problems)} problems, listed above")

    def _missing(self, episodes: list[ObjectNavEpisode]) -> list[str]:
        """A line for each scene that is not there or not whole."""
        from toponav.datasets import missing_file

        ids = dict.fromkeys(episode.scene_id for episode in episodes)
        told = (missing_file(scene_id, self.data) for scene_id in ids)
        return [f"missing  {line}" for line in told if line is not None]


def _line(episode: ObjectNavEpisode) -> str:
    x, y, z = episode.start
    return (
        f"{episode.scene} #{episode.index:<4d} {episode.target:18s} "
        f"start {x:8.2f} {y:8.2f} {z:6.2f} yaw {math.degrees(episode.yaw):6.1f}  "
        f"shortest {episode.geodesic_distance:6.2f} m  {len(episode.goals)} goals"
    )


def _summary(report: DatasetReport) -> list[str]:
    def counted(counts: dict[str, int]) -> str:
        return ", ".join(f"{count} {name}" for name, count in counts.items())

    return [
        f"{report.version}: {report.episodes} episodes, {report.unreachable} without a path",
        f"  scenes: {counted(report.by_scene)}",
        f"  targets: {counted(report.by_target)}",
        f"  {report.goals} goals with {report.viewpoints} viewpoints, "
        f"{report.viewpoint_spacing_m:.3f} m apart",
        *(f"  problem: {problem}" for problem in report.problems),
        *([] if report.problems else ["  checked: no problem found"]),
    ]


def _record(episode: ObjectNavEpisode) -> dict[str, Any]:
    return {
        "scene": episode.scene,
        "index": episode.index,
        "episode_id": episode.episode_id,
        "scene_id": episode.scene_id,
        "target": episode.target,
        "start": list(episode.start),
        "yaw": episode.yaw,
        "geodesic_distance": episode.geodesic_distance,
        "euclidean_distance": episode.euclidean_distance,
        "goals": len(episode.goals),
        "viewpoints": len(episode.viewpoints),
    }
