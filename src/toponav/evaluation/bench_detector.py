"""How well a detector sees in the simulator: precision and recall by class and by distance."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.envs.simulator.navigation import NavigableSurface
from toponav.envs.simulator.renderer import RenderedFrame, Renderer
from toponav.evaluation.bench_sim import CAMERA_HEIGHT_M, HFOV_DEG, camera_poses
from toponav.geometry import Intrinsics, Pose
from toponav.perception.base import Detector
from toponav.perception.object_masks import object_masks
from toponav.scenes.mesh import Scene
from toponav.types import Detections, Instance, Observation

MATCH_IOU = 0.4
"""Least IoU of a box with an object's true box for the object to count as found."""

MIN_VISIBLE_SHARE = 1 / 1000
"""Objects that fill less of an image are neither asked for nor held against a detector."""

LEAST_VISIBLE_SHARE = 1 / 10_000
"""Still smaller ones are taken for absent."""

COCO_FURNISHING = (
    "chair", "sofa", "plant", "bed", "table", "toilet", "tv_monitor", "laptop", "microwave", "oven",
    "sink", "fridge", "book", "bench", "bicycle", "car",
)  # fmt: skip
"""The classes of COCO that houses hold, which every model trained on it knows."""

DISTANCES_M = (2.0, 4.0)
"""Where the bins of distance end; the last one is open."""

SCORES = (0.5, 0.7)
"""Where the bins of the boxes' scores end; the last one is open."""


@dataclass
class Tally:
    """Counts of one class or one bin."""

    found: int = 0
    missed: int = 0
    false: int = 0

    def figures(self) -> dict[str, float | int | None]:
        """Precision and recall (None where nothing was there to count), and the counts."""
        boxes, objects = self.found + self.false, self.found + self.missed
        return {
            "objects": objects,
            "recall": self.found / objects if objects else None,
            "precision": self.found / boxes if boxes else None,
            "false": self.false,
        }


@dataclass
class DetectorBench:
    """Collects what a detector says about frames whose truth is known.

    Attributes:
        detector: Who is examined.
        vocabulary: What it is asked for; canonical names.
        by_class: Counts a category.
        by_distance: Counts a bin of distance: the object's, or the box's for what is no object.
        by_score: Counts a bin of the boxes' scores; nothing is missed there.
        centroid_m: Distance between the centroids of found and true clouds, a found object.
        cloud_iou: Intersection over union of their points.
        detect_ms: Of each image.
    """

    detector: Detector
    vocabulary: tuple[str, ...]
    by_class: dict[str, Tally] = field(default_factory=lambda: defaultdict(Tally))
    by_distance: dict[int, Tally] = field(default_factory=lambda: defaultdict(Tally))
    by_score: dict[int, Tally] = field(default_factory=lambda: defaultdict(Tally))
    centroid_m: list[float] = field(default_factory=list)
    cloud_iou: list[float] = field(default_factory=list)
    detect_ms: list[float] = field(default_factory=list)

    def examine(self, scene: Scene, size: tuple[int, int], frames: int, seed: int) -> None:
        """Show the detector frames from random places of a scene."""
        surface = NavigableSurface.build(scene.mesh, floors=scene.floors)
        renderer = Renderer(scene.mesh)
        intrinsics = Intrinsics.from_hfov(*size, HFOV_DEG)
        for pose in camera_poses(surface, frames, np.random.default_rng(seed)):
            frame = renderer.render(pose, intrinsics)
            self.add(frame, _observation(frame, pose, intrinsics), scene.mesh.instances)

    def add(
        self, frame: RenderedFrame, observation: Observation, instances: Sequence[Instance]
    ) -> None:
        """Count one frame."""
        started = time.perf_counter()
        seen = self.detector.detect(observation.rgb, self.vocabulary)
        self.detect_ms.append(1e3 * (time.perf_counter() - started))
        boxed = object_masks(observation, seen)
        # Boxes without depth behind them make no object, so they are no detections here either.
        truth = _visible_objects(frame, instances, self.vocabulary)
        matches = matched(boxed, truth)
        for row, label in enumerate(boxed.labels):
            by_score = self.by_score[int(np.searchsorted(SCORES, boxed.scores[row], "right"))]
            if row in matches:
                by_score.found += 1
            else:
                by_score.false += 1
                depth = frame.depth[boxed.masks[row]]
                self._count(label, float(np.median(depth)) if depth.size else 0.0, "false")
        found = {index: row for row, index in matches.items()}
        for index, (category, mask) in enumerate(truth):
            if np.count_nonzero(mask) < MIN_VISIBLE_SHARE * mask.size:
                continue
            depth = float(np.median(frame.depth[mask]))
            self._count(category, depth, "found" if index in found else "missed")
            if index in found:
                self._compare(boxed.masks[found[index]], mask, observation)

    def figures(self) -> dict[str, Any]:
        """All of it, ready for JSON."""
        ends, scores = [*DISTANCES_M, float("inf")], [*SCORES, 1.0]
        return {
            "by_class": {name: self.by_class[name].figures() for name in sorted(self.by_class)},
            "by_distance": {
                f"to {ends[k]:g} m": self.by_distance[k].figures() for k in sorted(self.by_distance)
            },
            "by_score": {
                f"score to {scores[k]:g}": self.by_score[k].figures() for k in sorted(self.by_score)
            },
            "false_an_image": sum(t.false for t in self.by_class.values()) / len(self.detect_ms)
            if self.detect_ms
            else None,
            "centroid_m": _median(self.centroid_m),
            "cloud_iou": _median(self.cloud_iou),
            "detect_ms": _median(self.detect_ms),
            "frames": len(self.detect_ms),
        }

    def _count(self, category: str, distance: float, what: str) -> None:
        for tally in (
            self.by_class[category],
            self.by_distance[int(np.searchsorted(DISTANCES_M, distance))],
        ):
            setattr(tally, what, getattr(tally, what) + 1)

    def _compare(
        self, mask: NDArray[np.bool_], true: NDArray[np.bool_], observation: Observation
    ) -> None:
        """The cloud of a found object beside the true one: points are pixels of one image.

        Where either has no return of depth there is no cloud, and nothing to compare.
        """
        measured = observation.depth > 0.0
        found, truth = mask & measured, true & measured
        if not found.any() or not truth.any():
            return
        self.cloud_iou.append(np.count_nonzero(found & truth) / np.count_nonzero(found | truth))
        apart = _centroid(found, observation) - _centroid(truth, observation)
        self.centroid_m.append(float(np.linalg.norm(apart)))


def matched(
    detections: Detections, truth: Sequence[tuple[str, NDArray[np.bool_]]]
) -> dict[int, int]:
    """Which detection is which object: the surest first, each object once, classes equal."""
    boxes = [_box(mask) for _, mask in truth]
    matches: dict[int, int] = {}
    for row in np.argsort(-detections.scores, kind="stable").tolist():
        free = [
            (_iou(detections.boxes[row], boxes[index]), index)
            for index, (category, _) in enumerate(truth)
            if category == canonical(detections.labels[row]) and index not in matches.values()
        ]
        best = max(free, default=(0.0, -1))
        if best[0] >= MATCH_IOU:
            matches[row] = best[1]
    return matches


def _visible_objects(
    frame: RenderedFrame, instances: Sequence[Instance], vocabulary: Sequence[str]
) -> list[tuple[str, NDArray[np.bool_]]]:
    """Category and (H, W) mask of each object of the vocabulary that can be seen at all."""
    ids, counts = np.unique(frame.instance_ids, return_counts=True)
    visible = ids[(counts >= LEAST_VISIBLE_SHARE * frame.instance_ids.size) & (ids >= 0)]
    return [
        (instances[k].category, frame.instance_ids == k)
        for k in visible
        if instances[k].category in vocabulary
    ]


def _observation(frame: RenderedFrame, pose: Pose, intrinsics: Intrinsics) -> Observation:
    foot = np.asarray(pose.translation) - (0.0, 0.0, CAMERA_HEIGHT_M)
    forward = pose.rotation[:, 2]
    base = Pose.from_yaw(float(np.arctan2(forward[1], forward[0])), foot)
    return Observation(frame.rgb, frame.depth, pose, base, intrinsics)


def _box(mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(4,) the box about a mask, x_min, y_min, x_max, y_max, max exclusive."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], np.float64)


def _iou(one: NDArray[Any], other: NDArray[Any]) -> float:
    low, high = np.maximum(one[:2], other[:2]), np.minimum(one[2:], other[2:])
    common = float(np.prod(np.maximum(high - low, 0.0)))
    areas = float(np.prod(one[2:] - one[:2]) + np.prod(other[2:] - other[:2]))
    return common / (areas - common)


def _centroid(mask: NDArray[np.bool_], observation: Observation) -> NDArray[np.float64]:
    """(3,) mean of the points of a mask, all of them measured, in the camera frame, metres."""
    camera = observation.intrinsics
    rows, columns = np.nonzero(mask)
    z = observation.depth[rows, columns].astype(np.float64)
    x, y = (columns - camera.cx) / camera.fx * z, (rows - camera.cy) / camera.fy * z
    return np.array([x.mean(), y.mean(), z.mean()])


def _median(values: Sequence[float]) -> float | None:
    return float(np.median(values)) if values else None
