"""Map and memory from a recording: Sections III-C and III-D without an agent that decides."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

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
from toponav.policy.evidence import EvidenceConfig, TargetEvidence
from toponav.types import Detections, Observation

NODE_SPACING_M = 2.0
"""Path length between two nodes of the memory. A recording has no waypoints, at which the paper
makes its nodes; this is about the length of its agent's legs."""

EVIDENCE = EvidenceConfig()
"""How sightings of an object are weighed, as the navigator weighs those of its target."""

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


def _with_evidence(view: MapView, evidence: Mapping[str, TargetEvidence]) -> MapView:
    """The map with those objects that more speaks for than against, over all views of them."""
    objects = {}
    for name, cloud in view.objects.items():
        sure = [
            candidate.own_points(EVIDENCE)
            for candidate in evidence[name].candidates
            if candidate.log_odds(EVIDENCE) >= EVIDENCE.accept
        ]
        if not sure:
            continue
        away, _ = cKDTree(np.concatenate(sure)).query(cloud.points)
        kept = away <= EVIDENCE.gap_m
        objects[name] = PointCloud(cloud.points[kept], cloud.colors[kept], cloud.counts[kept])
    return replace(view, objects=objects)


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
