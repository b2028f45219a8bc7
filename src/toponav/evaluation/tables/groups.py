"""Groups of episodes: what `--by` splits the runs of a table into."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from toponav.categories import readable
from toponav.evaluation.results import EpisodeResult
from toponav.evaluation.tables.runs import Run

GroupKind = Literal["category", "size", "size-fixed", "distance", "floor", "scene"]

SIZE_EDGES_M2 = (50.0, 100.0, 200.0)
"""A flat, a house, a large house, and beyond."""

DISTANCE_EDGES_M = (5.0, 10.0, 15.0)
"""Shortest paths: one room, a few rooms, across the house, and beyond."""

UNKNOWN = "unknown"
"""Group of the episodes that do not have what is asked for, such as those that never began."""


@dataclass(frozen=True)
class Grouping:
    """A way to split episodes.

    Attributes:
        title: What the groups are.
        names: All groups, in order.
        of: The group of an episode, one of `names`.
    """

    title: str
    names: tuple[str, ...]
    of: Callable[[EpisodeResult], str]

    def members(self, run: Run, name: str) -> list[EpisodeResult]:
        """A run's episodes in a group."""
        return [episode for episode in run.episodes if self.of(episode) == name]


def grouping(kind: GroupKind, runs: Sequence[Run]) -> Grouping:
    """The groups of a kind that occur in the runs; the same ones for all of them."""
    episodes = [episode for run in runs for episode in run.episodes]
    title, of, order = _KINDS[kind](episodes)
    found = {of(episode) for episode in episodes}
    known = [name for name in order if name in found] if order else sorted(found - {UNKNOWN})
    return Grouping(title, (*known, *(found & {UNKNOWN})), of)


_Kind = tuple[str, Callable[[EpisodeResult], str], tuple[str, ...]]
"""Title, group of an episode, and the groups in order (empty: sorted by name)."""


def _by_category(episodes: Sequence[EpisodeResult]) -> _Kind:
    del episodes
    return "category", lambda r: readable(r.target) or UNKNOWN, ()


def _by_scene(episodes: Sequence[EpisodeResult]) -> _Kind:
    del episodes
    return "scene", lambda r: r.scene, ()


def _by_floor(episodes: Sequence[EpisodeResult]) -> _Kind:
    del episodes
    same, other = "same floor", "other floor"
    return "floor of the target", lambda r: other if r.floor_change else same, (same, other)


def _by_distance(episodes: Sequence[EpisodeResult]) -> _Kind:
    del episodes
    names = _bin_names(DISTANCE_EDGES_M, "m", digits=0)
    return "shortest path", lambda r: _bin(r.shortest_path, DISTANCE_EDGES_M, names), names


def _by_fixed_size(episodes: Sequence[EpisodeResult]) -> _Kind:
    del episodes
    names = _bin_names(SIZE_EDGES_M2, "m2", digits=0)
    return "navigable area", lambda r: _bin(_area(r), SIZE_EDGES_M2, names), names


def _by_size(episodes: Sequence[EpisodeResult]) -> _Kind:
    """Thirds of the episodes by the area of their scenes."""
    areas = [_area(episode) for episode in episodes if math.isfinite(_area(episode))]
    thirds = np.quantile(areas, (1 / 3, 2 / 3)).tolist() if areas else []
    edges = tuple(sorted({round(float(edge), 1) for edge in thirds}))
    names = _bin_names(edges, "m2", digits=1)
    return "navigable area, thirds", lambda r: _bin(_area(r), edges, names), names


_KINDS: dict[GroupKind, Callable[[Sequence[EpisodeResult]], _Kind]] = {
    "category": _by_category,
    "size": _by_size,
    "size-fixed": _by_fixed_size,
    "distance": _by_distance,
    "floor": _by_floor,
    "scene": _by_scene,
}


def _area(episode: EpisodeResult) -> float:
    """Area of the scene, infinite where the record does not have it."""
    return episode.scene_m2 or math.inf


def _bin_names(edges: Sequence[float], unit: str, digits: int) -> tuple[str, ...]:
    texts = [f"{edge:.{digits}f}" for edge in edges]
    between = [f"{low}-{high} {unit}" for low, high in zip(["0", *texts], texts, strict=False)]
    return (*between, f"{texts[-1] if texts else '0'}+ {unit}")


def _bin(value: float, edges: Sequence[float], names: Sequence[str]) -> str:
    """The bin of a value; a bin has its lower edge, not its upper one."""
    if not math.isfinite(value):
        return UNKNOWN
    return names[sum(value >= edge for edge in edges)]
