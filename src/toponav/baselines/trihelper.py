"""TriHelper: L3MVN with three helpers: against traps, repeated goals and false detections.

Zhang and others 2024, "TriHelper: Zero-Shot Object Navigation with Dynamic Assistance".

Kept: all of L3MVN; after 6 blocked steps forward the agent turns and steps in turn until a step
succeeds; a goal that is chosen again less than 2.5 m away is left for 20 steps for a random point
on the edge of the known; in the first 300 steps a model is asked whether the image holds the target
that was detected: no strikes the detection, yes ends the questions.

Changed: the question is the reasoner's: yes if the image's relevance is one half or more. The
random point is a frontier cell that can be walked to.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toponav.baselines.l3mvn import REPLAN_STEPS, L3mvnAgent
from toponav.config import NavigatorConfig
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.perception.base import Detector
from toponav.policy.decision import DecisionListener
from toponav.reasoning.base import Reasoner
from toponav.types import Action, Detections, Observation

TRAPPED_BUMPS = 6
"""Blocked steps forward, with none that succeeds between them, that make a trap."""

REPEATED_M = 2.5
"""A goal that is chosen again nearer than this is a repeated one, metres in a straight line."""

DETOUR_STEPS = 20
"""Steps towards the random point."""

QUESTION_STEPS = 300
"""Detections are questioned in so many first steps."""

YES = 0.5
"""Relevance of an image from which the answer is yes."""


class TriHelperAgent(L3mvnAgent):
    """Goes where L3MVN goes, with help where that goes wrong."""

    def __init__(
        self,
        detector: Detector,
        reasoner: Reasoner,
        config: NavigatorConfig,
        seed: int,
        listener: DecisionListener,
    ) -> None:
        """Take L3MVN's parts and the seed of the random points."""
        self._seed = seed
        super().__init__(detector, reasoner, config, listener)

    def reset(self, goal: str) -> None:
        """Forget the last episode and draw the same points again."""
        super().reset(goal)
        self._rng = np.random.default_rng(self._seed)
        self._bumps = 0
        self._last_action = Action.STOP
        self._frames = 0
        self._confirmed = False
        self._goal_before: NDArray[np.float64] | None = None
        self._plan_steps = REPLAN_STEPS

    def act(self, observation: Observation) -> Action:
        """L3MVN's action, or a way out of a trap."""
        stepped = self._last_action is Action.MOVE_FORWARD
        if stepped:
            self._bumps = self._bumps + 1 if observation.collided else 0
        action = super().act(observation)
        if self._bumps >= TRAPPED_BUMPS and action is not Action.STOP:
            action = Action.TURN_LEFT if stepped else Action.MOVE_FORWARD
        self._last_action = action
        return action

    def _accepted(self, detections: Detections) -> Detections:
        """All detections, but those of the target only if the model confirms them."""
        self._frames += 1
        if self._confirmed or self._frames > QUESTION_STEPS:
            return detections
        found = np.array([label == self._target for label in detections.labels], dtype=np.bool_)
        if not found.any():
            return detections
        self._confirmed = self._relevances[0].of_image(detections) >= YES
        return detections if self._confirmed else detections.where(~found)

    def _replans(self, observation: Observation, view: MapView) -> bool:
        del view
        return observation.step - self._planned_at >= self._plan_steps

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        """L3MVN's choice, or a random frontier cell where that is a repeated one."""
        chosen = super()._choose(clusters, reach, observation, view)
        self._plan_steps = REPLAN_STEPS
        if self._is_repeated(chosen, observation):
            cells = np.concatenate([cluster.cells[cluster.reachable] for cluster in clusters])
            chosen = np.append(cells[self._rng.integers(len(cells))], view.floor_z)
            self._plan_steps = DETOUR_STEPS
        self._goal_before = chosen
        return chosen

    def _is_repeated(self, chosen: NDArray[np.float64], observation: Observation) -> bool:
        """Whether a goal close by is chosen for a second time in a row."""
        if self._goal_before is None or not np.array_equal(chosen, self._goal_before):
            return False
        here = observation.world_from_base.translation
        return bool(np.hypot(*(chosen - here)[:2]) < REPEATED_M)
