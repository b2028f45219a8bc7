"""The watcher of a search, on the small house: when each stage was reached, and how it ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from small_house import small_runner
from toponav.envs.simulator import HouseEnv
from toponav.evaluation import funnel
from toponav.evaluation.funnel import SearchTrace
from toponav.evaluation.rollout import EpisodeSpec, Rollout, roll_out
from toponav.evaluation.runner import SceneRunner
from toponav.evaluation.search_watch import CLAIM_STEPS, STUCK_STEPS, SearchWatch
from toponav.mapping.view import MapView, OccupancyGrid, PointCloud
from toponav.perception import OracleDetector
from toponav.perception.base import Detector
from toponav.policy.affordances import Phase
from toponav.policy.decision import Decision
from toponav.scenes.mesh import SceneEpisode
from toponav.types import Action, Detections, Observation

LIMIT = 130
TARGET = "toilet"
TURN, STOP = Action.TURN_LEFT, Action.STOP
AROUND = [TURN] * 12


@cache
def small() -> SceneRunner:
    return small_runner(max_steps=LIMIT)


def env() -> HouseEnv:
    return small().env


def at(place: NDArray[np.float64]) -> EpisodeSpec:
    """An episode that starts somewhere, looking along +x."""
    x, y, z = (float(v) for v in place)
    return replace(small().episode(0), episode=SceneEpisode(TARGET, (x, y, z), 0.0))


def drawn(suits: Callable[[int, float], bool]) -> EpisodeSpec:
    """Starts where the most target pixels of a look around, and the DTG, are as wanted."""
    rng = np.random.default_rng(0)
    for _ in range(200):
        spec = at(env().surface.random_point(rng))
        seen = max(target_pixels(spec, AROUND))
        if suits(seen, env().oracle.distance_to_goal()):
            return spec
    raise AssertionError("there is no such place")


@cache
def hidden() -> EpisodeSpec:
    """Starts where the target cannot be seen, however one turns."""
    return drawn(lambda seen, dtg: seen == 0 and dtg > 3.0)


@cache
def across() -> EpisodeSpec:
    """Starts where the target can be seen, but not near it."""
    return drawn(lambda seen, dtg: seen > 20 and dtg > funnel.TOO_FAR_M)


@cache
def beside() -> EpisodeSpec:
    """Starts near the target, but not near enough."""
    return drawn(lambda seen, dtg: seen > 20 and 0.2 < dtg < funnel.TOO_FAR_M)


@dataclass
class Pixels:
    """A step observer that counts the target's pixels before every action."""

    counts: list[int] = field(default_factory=list)

    def on_step(self, observation: Observation, action: Action) -> None:
        frame = env().oracle.semantic_frame()
        ids = [k for k, item in enumerate(frame.instances) if item.category == TARGET]
        self.counts.append(int(np.isin(frame.instance_ids, ids).sum()))


class Looking:
    """An agent that asks its detector at every step, plays actions, and tells of decisions."""

    def __init__(
        self,
        actions: Sequence[Action],
        detector: Detector | None = None,
        tell: Callable[[Decision], None] = lambda decision: None,
        waypoints: Mapping[int, NDArray[np.float64] | None] | None = None,
    ) -> None:
        self._actions, self._detector, self._tell = actions, detector, tell
        self._waypoints = waypoints or {}

    def reset(self, goal: str) -> None:
        self._goal = goal

    def act(self, observation: Observation) -> Action:
        if self._detector is not None:
            self._detector.detect(observation.rgb, (self._goal, "bed"))
        if observation.step in self._waypoints:
            self._tell(acquisition(observation.step, self._waypoints[observation.step]))
        return self._actions[observation.step] if observation.step < len(self._actions) else TURN

    def close(self) -> None:
        """Nothing to release."""


def acquisition(step: int, waypoint: NDArray[np.float64] | None) -> Decision:
    nothing = PointCloud(
        np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint8), np.zeros(0, np.int32)
    )
    grid = OccupancyGrid(np.zeros((1, 1), np.int8), (0.0, 0.0), 0.1)
    view = MapView(
        scene=nothing, objects={}, navigable=nothing, obstacles=nothing,
        frontiers=np.zeros((0, 3)), frontier_labels=np.zeros(0, np.int64), grid=grid, floor_z=0.0,
    )  # fmt: skip
    return Decision(
        index=0, step=step, phase=Phase.TARGET_ACQUISITION, waypoint=waypoint,
        path=np.zeros((0, 2)), map_view=view,
    )  # fmt: skip


def target_pixels(spec: EpisodeSpec, actions: Sequence[Action]) -> list[int]:
    pixels = Pixels()
    roll_out(env(), Looking([*actions, STOP]), spec, (pixels,))
    return pixels.counts


def watched(
    spec: EpisodeSpec,
    actions: Sequence[Action],
    detector: Detector | None = None,
    waypoints: Mapping[int, NDArray[np.float64] | None] | None = None,
) -> Rollout:
    """What the watcher tells of an agent with `detector`, by default the oracle."""
    watch = SearchWatch(detector or OracleDetector(env().oracle), env().oracle)
    agent = Looking(actions, watch, watch.on_decision, waypoints)
    rollout = roll_out(env(), agent, spec, (watch,))
    watch.tell(rollout)
    return rollout


class Finding:
    """A detector that finds the target in the same part of every image."""

    def __init__(self, mask: NDArray[np.bool_] | None) -> None:
        self._mask = mask

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        n = 0 if self._mask is None else 1
        masks = np.zeros((n, *rgb.shape[:2]), bool)
        if self._mask is not None:
            masks[0] = self._mask
        return Detections(
            (TARGET,) * n, np.ones(n, np.float32), np.zeros((n, 4), np.float32), masks
        )


class Until:
    """A detector that goes blind at a step."""

    def __init__(self, detector: Detector, steps: int) -> None:
        self._detector, self._left = detector, steps

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        self._left -= 1
        return (self._detector if self._left >= 0 else NOTHING).detect(rgb, vocabulary)


NOTHING, EVERYTHING = Finding(None), Finding(np.ones((120, 160), bool))


def waypoint() -> NDArray[np.float64]:
    return np.asarray(env().oracle.viewpoints(TARGET)[0])


def test_visible_is_the_first_step_with_enough_pixels() -> None:
    counts = target_pixels(across(), AROUND)
    enough = 25 * (160 * 120) / (640 * 480)  # 25 pixels of the protocol's image
    first = next(k for k, count in enumerate(counts) if count >= enough)
    search = watched(across(), [*AROUND, STOP]).search
    assert (search.visible_step, search.detected_step) == (first, first)
    assert search.approached_step is None
    assert search.closest_m == env().oracle.distance_to_goal()


def test_what_never_comes_into_view() -> None:
    rollout = watched(hidden(), [*AROUND, STOP])
    assert rollout.search == SearchTrace(closest_m=env().oracle.distance_to_goal())
    assert rollout.failure == funnel.NEVER_VISIBLE


def test_what_the_detector_does_not_find() -> None:
    rollout = watched(across(), [*AROUND, STOP], NOTHING)
    assert rollout.search.visible_step is not None
    assert rollout.search.detected_step is None
    assert rollout.failure == funnel.NOT_DETECTED


def test_what_it_takes_for_the_target_beside_it_is_no_detection_of_it() -> None:
    rollout = watched(across(), [*AROUND, *AROUND, STOP], EVERYTHING)
    assert rollout.search.visible_step is not None
    assert rollout.search.detected_step is None
    assert rollout.failure == funnel.WRONG_THING  # it stops with what it saw before its eyes


def test_a_stop_long_after_the_last_sighting_gives_up_and_one_soon_after_claims() -> None:
    oracle = OracleDetector(env().oracle)
    soon = watched(across(), [*AROUND, STOP], Until(oracle, len(AROUND)))
    assert soon.failure == funnel.WRONG_THING
    turns = [TURN] * (CLAIM_STEPS + len(AROUND))
    late = watched(across(), [*turns, STOP], Until(oracle, len(AROUND)))
    assert late.failure == funnel.NOT_APPROACHED


def test_a_stop_beside_the_target_is_too_far() -> None:
    rollout = watched(beside(), [*AROUND, STOP])
    assert rollout.failure == funnel.TOO_FAR
    assert rollout.search.detected_step is not None


def test_a_stop_at_a_viewpoint_is_no_failure_whatever_was_seen() -> None:
    rollout = watched(at(waypoint()), [STOP], NOTHING)
    assert rollout.distance_to_goal < 0.1
    assert rollout.failure == ""


@pytest.mark.parametrize(("off", "approaches"), [(0.0, True), (1.5, True), (60.0, False)])
def test_setting_out_for_the_target_is_a_waypoint_near_a_viewpoint(
    off: float, approaches: bool
) -> None:
    goal = waypoint() + np.array([off, 0.0, 0.0])
    rollout = watched(across(), [*AROUND, *AROUND, STOP], waypoints={5: None, 7: goal, 9: goal})
    assert rollout.search.approached_step == (7 if approaches else None)
    assert rollout.decisions == 3


def test_an_agent_that_stays_on_one_spot_is_stuck() -> None:
    assert LIMIT >= STUCK_STEPS
    assert watched(across(), []).failure == funnel.STUCK


def test_one_that_moves_on_its_way_until_the_limit_ran_out_of_steps() -> None:
    rollout = watched(across(), pacing(), waypoints={12: waypoint()})
    assert rollout.ended == "step-limit"
    assert rollout.failure == funnel.STEP_LIMIT


def pacing() -> list[Action]:
    """Looks around, then goes to and fro over more than the size of one spot."""
    return [*AROUND, *([Action.MOVE_FORWARD] * 8 + [TURN] * 6) * 10]


def test_the_detector_s_answer_is_passed_on_unchanged() -> None:
    env().reset(options={"target": TARGET, "start": (*across().episode.start, 0.0)})
    rgb = env().observe().rgb
    watch = SearchWatch(EVERYTHING, env().oracle)
    seen, true = watch.detect(rgb, (TARGET,)), EVERYTHING.detect(rgb, (TARGET,))
    assert seen.labels == true.labels
    np.testing.assert_array_equal(seen.masks, true.masks)


def test_a_real_search_passes_its_stages_in_order() -> None:
    runner = small_runner()
    result = runner.run(runner.episode(0))
    assert result.succeeded
    assert result.failure == ""
    search = result.search
    assert search.visible_step is not None
    assert search.detected_step is not None
    assert search.approached_step is not None
    assert search.visible_step <= search.detected_step <= search.approached_step <= result.steps
    assert search.closest_m <= result.shortest_path
    assert math.isfinite(search.closest_m)
