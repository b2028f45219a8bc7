"""What the frontier-based methods share: turns, choices that stand, walks that end early."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from searches import Blind, Log, small_env

from small_house import small_config
from toponav.baselines.frontier_search import FrontierSearch
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField
from toponav.mapping.view import MapView
from toponav.types import Action, Observation


class Restless(FrontierSearch):
    """Plans anew at every step: for one frontier, or for two by turns."""

    initial_turn_deg = 90.0
    wavers = False

    def _replans(self, observation: Observation, view: MapView) -> bool:
        return True

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        cells = np.concatenate([cluster.cells[cluster.reachable] for cluster in clusters])
        farthest = cells[np.argsort(-reach.at(cells), kind="stable")]
        pick = observation.step % 2 if self.wavers and len(cells) > 1 else 0
        return np.append(farthest[pick], view.floor_z)


class Wavering(Restless):
    wavers = True


class EasyGoing(FrontierSearch):
    """Stays with the nearest frontier and is content with half a metre."""

    initial_turn_deg = 0.0
    arrival_turn_deg = 60.0
    exploring_arrival_m = 0.5

    def _choose(
        self,
        clusters: Sequence[FrontierCluster],
        reach: CostField,
        observation: Observation,
        view: MapView,
    ) -> NDArray[np.float64]:
        return min(clusters, key=lambda cluster: cluster.path_cost).nearest


@dataclass
class Played:
    log: Log
    agent: FrontierSearch


def frozen(kind: type[FrontierSearch], steps: int) -> Played:
    """An agent whose actions have no effect: it sees the start of an episode over and over."""
    env, log = small_env(), Log()
    env.reset(seed=0, options={"target": "toilet"})
    agent = kind(Blind(), small_config().navigator, log)
    for step in range(steps):
        log.observations.append(replace(env.observe(), step=step))
        log.actions.append(agent.act(log.observations[-1]))
    return Played(log, agent)


def test_the_first_turn_is_as_long_as_the_method_says() -> None:
    actions = frozen(Restless, 4).log.actions
    assert actions[:3] == [Action.TURN_LEFT] * 3
    assert len(frozen(Restless, 3).log.decisions) == 0
    assert len(frozen(Restless, 4).log.decisions) == 1


def test_a_choice_that_stands_is_no_new_decision() -> None:
    assert len(frozen(Restless, 12).log.decisions) == 1
    assert len(frozen(Wavering, 12).log.decisions) == 9


def test_changing_ones_mind_does_not_make_a_walk_without_progress_go_on_for_ever() -> None:
    window = small_config().navigator.locomotion.recovery.window_steps
    log = frozen(Wavering, 6 + window).log  # a turn, the walk, a last look, another frontier
    first, last = log.decisions[0].waypoint, log.decisions[-1].waypoint
    assert first is not None
    assert last is not None
    radius = small_config().navigator.locomotion.recovery.barren_radius_m
    assert np.hypot(*(first - last)[:2]) > radius or log.actions[-1] is Action.STOP


def test_a_walk_ends_as_early_as_the_method_says_with_the_turn_it_says() -> None:
    env, log = small_env(), Log()
    env.reset(seed=0, options={"target": "toilet"})
    agent = EasyGoing(Blind(), small_config().navigator, log)
    while len(log.decisions) < 3:
        log.observations.append(env.observe())
        log.actions.append(agent.act(env.observe()))
        env.step(int(log.actions[-1]))
    for first, second in ((0, 1), (1, 2)):
        waypoint, step = log.decisions[first].waypoint, log.decisions[second].step
        assert waypoint is not None
        at = [np.hypot(*(waypoint - o.world_from_base.translation)[:2]) for o in log.observations]
        assert at[step] <= EasyGoing.exploring_arrival_m
        assert log.actions[step - 2 : step] == [Action.TURN_LEFT] * 2
        already_there = step - 3 == log.decisions[first].step
        assert at[step - 3] > EasyGoing.exploring_arrival_m or already_there
