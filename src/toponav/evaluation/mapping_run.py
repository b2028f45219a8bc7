"""Map and memory from a recording: Sections III-C and III-D without an agent that decides."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.config import NavigatorConfig
from toponav.mapping.ply import write_ply
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import MapView, PointCloud
from toponav.memory.builder import MemoryBuilder
from toponav.memory.graph import TopologicalMemory
from toponav.perception.base import Detector
from toponav.perception.object_masks import object_masks
from toponav.policy.candidate import EvidenceConfig
from toponav.policy.evidence import TargetEvidence
from toponav.types import Detections, Observation

NODE_SPACING_M = 2.0
"""Path length between two nodes of the memory. A recording has no waypoints, at which the paper
makes its nodes; this is about the length of its agent's legs."""

EVIDENCE = EvidenceConfig()
"""How sightings of an object are weighed, as the navigator weighs those of its target."""

SAME_SHARE = 0.3
"""Clouds of different names that share this much of their union are one thing."""

Progress = Callable[[int, int], None]
"""Called with the frames done and the frames in all."""


@dataclass(frozen=True, eq=False)
class MappingRun:
    """What a recording gave.

    Attributes:
        view: The map after the last frame, on the floor of that frame. Of M_obj it holds what the
            views together speak for.
        memory: Nodes along the path.
        trajectory: (T, 3) foot points, metres.
        map_bytes: Memory that the map held, bytes.
    """

    view: MapView
    memory: TopologicalMemory
    trajectory: NDArray[np.float64]
    map_bytes: int


class Observations(Protocol):
    """Posed images in order: a recording of any kind."""

    def __len__(self) -> int:
        """How many there are, or at most are."""
        ...

    def __iter__(self) -> Iterator[Observation]:
        """One after the other."""
        ...


def map_recording(
    recording: Observations,
    detector: Detector | None = None,
    config: NavigatorConfig | None = None,
    progress: Progress | None = None,
) -> MappingRun:
    """Integrate every frame of a recording, and remember the places that it passes.

    Args:
        recording: At least one frame.
        detector: Finds the vocabulary's categories; without one, M_obj stays empty.
        config: Parameters of map and memory, and the vocabulary; the defaults when left out.
        progress: Told after every frame.

    Raises:
        RecordingError: A frame is damaged.
    """
    config = config or NavigatorConfig()
    semantic_map, memory = SemanticMap(config.map), MemoryBuilder(config.memory)
    evidence: dict[str, TargetEvidence] = {}
    trajectory: list[NDArray[np.float64]] = []
    since_node = np.inf
    for index, observation in enumerate(recording):
        if detector is None:
            detections = Detections.empty(*observation.depth.shape)
        else:
            seen = detector.detect(observation.rgb, config.vocabulary)
            detections = object_masks(observation, seen)
        semantic_map.integrate(observation, detections)
        for name in dict.fromkeys((*evidence, *detections.labels)):
            evidence.setdefault(name, TargetEvidence(EVIDENCE, name)).observe(
                observation, detections
            )
        foot = observation.world_from_base.translation
        if trajectory:
            since_node += float(np.linalg.norm(foot - trajectory[-1]))
        trajectory.append(foot)
        if since_node >= NODE_SPACING_M:
            travelled = 0.0 if index == 0 else since_node
            place = (float(foot[0]), float(foot[1]))
            memory.arrive(place, semantic_map.view(), travelled)
            since_node = 0.0
        if progress is not None:
            progress(index + 1, len(recording))
    view = _with_evidence(semantic_map.view(), evidence)
    memory.refresh(view)
    return MappingRun(view, memory.memory, np.array(trajectory), semantic_map.nbytes)


class _Find(NamedTuple):
    """Something that a recording shows: its name, its points (N, 3), what speaks for it."""

    name: str
    points: NDArray[np.float64]
    log_odds: float


def _with_evidence(view: MapView, evidence: Mapping[str, TargetEvidence]) -> MapView:
    """The map with those objects that more speaks for than against, over all views of them.

    What an agent would look at from one more side has to be judged as it is: a recording goes
    nowhere. Of two names for one thing the likelier is kept.
    """
    finds = [
        _Find(name, candidate.own_points(EVIDENCE), candidate.log_odds(EVIDENCE))
        for name, of_name in evidence.items()
        for candidate in of_name.candidates
    ]
    likely = [find for find in finds if find.log_odds >= EVIDENCE.probable and len(find.points)]
    kept: list[_Find] = []
    for find in sorted(likely, key=lambda one: -one.log_odds):
        if not any(_same_thing(find.points, surer.points) for surer in kept):
            kept.append(find)
    objects = {}
    for name, cloud in view.objects.items():
        own = [find.points for find in kept if find.name == name]
        if own:
            away, _ = cKDTree(np.concatenate(own)).query(cloud.points)
            rows = away <= EVIDENCE.gap_m
            objects[name] = PointCloud(cloud.points[rows], cloud.colors[rows], cloud.counts[rows])
    return replace(view, objects=objects)


def _same_thing(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether two clouds share so much that they are one thing; a book on a table is another."""
    away, _ = cKDTree(other).query(one)
    back, _ = cKDTree(one).query(other)
    near = min(np.count_nonzero(away <= EVIDENCE.gap_m), np.count_nonzero(back <= EVIDENCE.gap_m))
    return bool(near >= SAME_SHARE * (len(one) + len(other) - near))


def write_clouds(view: MapView, folder: Path) -> dict[str, Path]:
    """Write M_scene, M_nav, M_obs and every M_obj^(c) as PLY files.

    Args:
        view: The map.
        folder: Made if need be; categories go to its subfolder `objects`.

    Returns:
        Path of each cloud by name: `scene`, `navigable`, `obstacles`, `objects/<category>`.
    """
    clouds: dict[str, PointCloud] = {
        "scene": view.scene,
        "navigable": view.navigable,
        "obstacles": view.obstacles,
    }
    for category, cloud in sorted(view.objects.items()):
        clouds[f"objects/{_file_stem(category)}"] = cloud
    paths = {name: folder / f"{name}.ply" for name in clouds}
    for name, cloud in clouds.items():
        write_ply(paths[name], cloud)
    return paths


def _file_stem(category: str) -> str:
    """A category, which is free text, as the name of a file."""
    return re.sub(r"[^\w-]+", "_", category)
