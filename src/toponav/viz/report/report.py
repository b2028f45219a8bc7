"""`toponav report`: finished runs as one page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from toponav.evaluation.statistics import Resampling
from toponav.evaluation.tables.runs import Run
from toponav.files import write_atomic
from toponav.viz.report.episode_data import episode_data
from toponav.viz.report.episode_files import read_episode
from toponav.viz.report.overview import overview
from toponav.viz.report.page import packed, page
from toponav.viz.report.pictures import Pictures

MEGABYTE = 1_000_000
OnEpisode = Callable[[int, int], None]


@dataclass(frozen=True)
class Written:
    """What was written.

    Attributes:
        path: The page.
        size: Bytes.
        episodes: On it, of all runs.
        explained: Of them with a map of every decision.
        pictures: On it; equal ones are there once.
    """

    path: Path
    size: int
    episodes: int
    explained: int
    pictures: int


def write_report(
    runs: Sequence[Run],
    path: Path,
    max_mb: float,
    resampling: Resampling | None = None,
    on_episode: OnEpisode = lambda done, total: None,
) -> Written:
    """Write the page; the same runs make the same bytes.

    Args:
        runs: One or more, with different names.
        path: The HTML file, replaced whole.
        max_mb: Size at which pictures are made smaller, megabytes.
        resampling: How means get their intervals.
        on_episode: Told how many episodes of how many have been read.

    Raises:
        InputError: A damaged record.
        OSError: The page cannot be written.
    """
    pictures, episodes, explained = Pictures(), {}, 0
    total = sum(len(run.episodes) for run in runs)
    for r, run in enumerate(runs):
        for k, result in enumerate(run.episodes):
            data = episode_data(read_episode(run.folder, result), pictures)
            explained += any("map" in decision for decision in data["decisions"])
            episodes[f"e-{r}-{k}"] = packed(data)
            on_episode(len(episodes), total)
    seen = overview(runs, resampling or Resampling())
    title = f"TopoNav: {', '.join(run.name for run in runs)}"
    bare = len(page(title, seen, episodes, {}))
    images = pictures.encoded(max_mb * MEGABYTE - bare)
    text = page(title, seen, episodes, images)
    write_atomic(path, text)
    return Written(path, len(text), total, explained, len(images))
