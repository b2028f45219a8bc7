"""`toponav render`: pictures and videos of a recorded episode."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from toponav.cli.options import JsonFlag

if TYPE_CHECKING:
    from toponav.evaluation.replay import RecordedEpisode

What = Literal["topdown", "panorama", "video"]
KINDS: dict[str, tuple[str, ...]] = {
    "topdown": (".png", ".svg", ".pdf"),
    "panorama": (".png", ".jpg"),
    "video": (".gif", ".mp4"),
}
"""Kinds of files; the first is the default."""


@dataclass(frozen=True)
class Render:
    """Draw a recorded episode: a top-down map, a panorama, or a video.

    The episode is run again, and must take the recorded path.
    """

    episode: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="EPISODE")]
    """Folder of `toponav demo` or `run`, or one of RUN/episodes."""

    what: What = "topdown"
    """What to draw."""

    out: Path | None = None
    """File: .png, .svg or .pdf for topdown, .png or .jpg for panorama, .gif or .mp4 for video (MP4
    needs the extra `viz`); by default EPISODE/WHAT.png, or video.gif."""

    decision: int | None = None
    """Draw the search as it was at this decision, from 0; by default the end of the search, and the
    last panorama."""

    rate: float = 8.0
    """Steps of the search a second of a video."""

    every: int = 1
    """Show every n-th step in a video."""

    json: JsonFlag = False
    """Print the result as one JSON object on stdout."""

    def run(self) -> None:
        """Run the episode again and draw it."""
        from toponav.cli.console import Output
        from toponav.errors import InputError
        from toponav.evaluation.replay import open_episode

        path = self.out or self.episode / f"{self.what}{KINDS[self.what][0]}"
        if path.suffix not in KINDS[self.what]:
            kinds = ", ".join(KINDS[self.what])
            raise InputError(f"{path}: {self.what} is written as {kinds}; choose one of these")
        if self.every < 1 or not self.rate > 0.0:
            raise InputError("--every and --rate take positive numbers")
        output = Output(self.json)
        episode = open_episode(self.episode)
        output.say(f"running {episode.result.scene} #{episode.result.index} again")
        path.parent.mkdir(parents=True, exist_ok=True)
        data: dict[str, Any] = {"file": str(path), "what": self.what}
        if self.what == "video":
            data["frames"] = self._film(episode, path)
        else:
            self._still(episode, path)
        output.result(f"wrote {path}", data)

    def _film(self, episode: RecordedEpisode, path: Path) -> int:
        from toponav.cli.episode import result_line
        from toponav.viz.film import FilmCamera, draw_film, import_ffmpeg, save_film

        if path.suffix == ".mp4":
            import_ffmpeg()
        camera = FilmCamera(episode.config.navigator.map, self.every)
        result = episode.replay((camera,), (camera,))
        return save_film(draw_film(camera, result.target, result_line(result)), path, self.rate)

    def _still(self, episode: RecordedEpisode, path: Path) -> None:
        from toponav.cli.episode import figures, headline
        from toponav.viz.panorama import save_panorama
        from toponav.viz.stills import StillCamera
        from toponav.viz.topdown import save_topdown

        camera = StillCamera()
        result = episode.replay((camera,), (camera,))
        if self.what == "panorama":
            decision = camera.panorama(self.decision)
            save_panorama(decision.panorama, decision.guidance, result.target, path)
        elif self.decision is None:
            save_topdown(camera.last(result.target, headline(result), figures(result)), path)
        else:
            save_topdown(camera.at(self.decision, result.target, result.scene), path)
