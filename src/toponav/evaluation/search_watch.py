"""Watches an episode for the stages of its search, with the ground truth at hand."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator.oracle import SceneOracle
from toponav.evaluation.funnel import SearchEnd, SearchTrace, failure_of
from toponav.evaluation.metrics import BENCHMARK_RADIUS_M, success
from toponav.evaluation.rollout import Rollout
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.perception.base import Detector
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision
from toponav.types import Action, Detections, Observation, SemanticFrame

VISIBLE_PIXELS_PER_MEGAPIXEL = 80.0
"""Fewer pixels of the target are not in view: 25 pixels of a 640 x 480 image."""

TRUE_SHARE = 0.5
"""Share of a detection's pixels that must lie on the target for it to be a detection of it."""

APPROACH_M = 2.0
"""A waypoint this near to a viewpoint of the target leads to it, not to something else."""

CLAIM_STEPS = 12
"""A stop this soon after a sighting claims the target, a later one gives up: one panorama."""

STUCK_STEPS = 100
STUCK_M = 1.0
"""An agent that has not left a circle of this radius for so many steps is stuck."""


class SearchWatch:
    """A detector around the agent's, a step observer and a decision listener of one episode.

    It steers nothing: detections pass through unchanged.
    """

    def __init__(self, detector: Detector, oracle: SceneOracle) -> None:
        """Watch what `detector` finds in the episode that `oracle` knows."""
        self._detector = detector
        self._oracle = oracle
        self._step = 0
        self._decisions = 0
        self._visible: int | None = None
        self._detected: int | None = None
        self._approached: int | None = None
        self._closest = math.inf
        self._last_sighting = -math.inf
        self._phase = Phase.EXPLORATION
        self._path: list[NDArray[np.float64]] = []

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """The agent's detector's answer, looked at."""
        detections = self._detector.detect(rgb, vocabulary)
        found = [k for k, label in enumerate(detections.labels) if label == self._oracle.target]
        if found:
            self._last_sighting = self._step
        if self._visible is None or (found and self._detected is None):
            on_target = _target_pixels(self._oracle.semantic_frame(), self._oracle.target)
            enough = VISIBLE_PIXELS_PER_MEGAPIXEL * 1e-6 * on_target.size
            if self._visible is None and np.count_nonzero(on_target) >= max(1.0, enough):
                self._visible = self._step
            if any(_share(detections.masks[k], on_target) >= TRUE_SHARE for k in found):
                self._detected = self._step
        return detections

    def on_step(self, observation: Observation, action: Action) -> None:
        """Follow the agent."""
        del action
        self._step = observation.step + 1
        self._path.append(observation.world_from_base.translation[:2])
        self._closest = min(self._closest, self._oracle.distance_to_goal())

    def on_decision(self, decision: Decision) -> None:
        """See whether the agent sets out for the target."""
        self._decisions += 1
        self._phase = decision.phase
        if decision.phase is not Phase.TARGET_ACQUISITION or decision.waypoint is None:
            return
        viewpoints = self._oracle.viewpoints(self._oracle.target)
        off = np.linalg.norm(viewpoints[:, :2] - decision.waypoint[:2], axis=1)
        if self._approached is None and off.min(initial=math.inf) <= APPROACH_M:
            self._approached = decision.step

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Nothing to do: how the episode ended is told by its rollout."""

    def tell(self, rollout: Rollout) -> None:
        """Write what was seen into the finished episode's record."""
        rollout.decisions = self._decisions
        rollout.search = SearchTrace(self._visible, self._detected, self._approached, self._closest)
        if not success(rollout.stopped, rollout.distance_to_goal, BENCHMARK_RADIUS_M):
            rollout.failure = failure_of(rollout.search, self._end(rollout))

    def _end(self, rollout: Rollout) -> SearchEnd:
        approaching = self._phase is Phase.TARGET_ACQUISITION
        recent = np.array(self._path[-STUCK_STEPS:]).reshape(-1, 2)
        strayed = np.linalg.norm(recent - recent[-1:], axis=1).max(initial=0.0)
        return SearchEnd(
            ended=rollout.ended,
            distance_to_goal=rollout.distance_to_goal,
            approaching=approaching,
            claimed=approaching or self._step - self._last_sighting <= CLAIM_STEPS,
            stuck=len(recent) == STUCK_STEPS and bool(strayed < STUCK_M),
        )


def _share(mask: NDArray[np.bool_], on_target: NDArray[np.bool_]) -> float:
    """Share of a mask's pixels that lie on the target; 0 for an empty mask."""
    return int(np.count_nonzero(mask & on_target)) / max(int(np.count_nonzero(mask)), 1)


def _target_pixels(frame: SemanticFrame, target: str) -> NDArray[np.bool_]:
    """(H, W) bool: where the image shows an instance of the target."""
    is_target = [instance.category == target for instance in frame.instances]
    with_nothing = np.array([*is_target, False])  # what was hit by no ray is -1: the last
    return np.asarray(with_nothing[frame.instance_ids])
