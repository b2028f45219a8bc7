"""TopoNav, the paper's Section III as one loop: perceive, map, remember, reason, walk.

`Navigator.act` is the pipeline, and `Navigator._decide` what happens at a waypoint, in the paper's
order; each line calls the room of that name.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.config import NavigatorConfig
from toponav.control.drops import ON_FLIGHT_M
from toponav.control.guide import Guide
from toponav.control.locomotion import Locomotion, Progress
from toponav.control.planned_search import Hints, PlannedSearch, Standing
from toponav.control.planner import CostField
from toponav.control.recovery import BarrenWaypoints
from toponav.control.vantage import further_look, vantage_point
from toponav.geometry import Pose
from toponav.knowledge import Knowledge
from toponav.mapping.semantic_map import SemanticMap
from toponav.mapping.view import FrameUpdate, MapView
from toponav.memory.builder import MemoryBuilder
from toponav.perception.base import Detector
from toponav.perception.object_masks import object_masks
from toponav.policy.affordances import Affordances, Phase, acquisition, exploration
from toponav.policy.decision import Decision, DecisionListener, Listeners
from toponav.policy.goal import GoalTracker
from toponav.policy.odometry import Odometry
from toponav.policy.waypoints import select_waypoint
from toponav.reasoning.base import Query, Reasoner
from toponav.reasoning.counsel import Counsel, Waiting, counsel
from toponav.reasoning.panorama import Panorama
from toponav.reasoning.prior import PriorReasoner
from toponav.reasoning.schema import Guidance
from toponav.types import Action, Detections, Observation

LONGEST_LOOK = 25
"""Steps that the way to another side of a candidate may take: some cannot be walked after all."""


@dataclass(frozen=True, eq=False)
class Frame:
    """One frame and what was made of it."""

    observation: Observation
    detections: Detections
    update: FrameUpdate
    view: MapView


@dataclass(frozen=True, eq=False)
class Asked:
    """The last question to the reasoner, and where the camera was when it was asked."""

    query: Query
    world_from_camera: Pose


class Navigator:
    """Finds an object of a named category from posed RGB-D images; an `Agent`."""

    def __init__(
        self,
        detector: Detector,
        reasoner: Reasoner,
        config: NavigatorConfig | None = None,
        listener: DecisionListener | None = None,
    ) -> None:
        """Compose the parts.

        Args:
            detector: Finds the categories of the vocabulary in an image.
            reasoner: Plays the VLM of Section III-E.
            config: Every parameter; the paper's by default.
            listener: Watches the decisions.
        """
        self.config = config or NavigatorConfig()
        self._detector = detector
        self._reasoner = reasoner
        self._counsel: Counsel = Waiting(reasoner)
        self._listener = listener or Listeners()
        self._recalled: Knowledge | None = None
        self._guide: Guide | None = None
        self.reset("")

    def follow(self, guide: Guide) -> None:
        """Walk as a guide says, from the next episode on: only to compare."""
        self._guide = guide

    def reset(self, goal: str) -> None:
        """Forget the last episode and look for an object of category `goal`."""
        config = self.config
        self._target = canonical(goal)
        self._vocabulary = tuple(dict.fromkeys((self._target, *config.vocabulary)))
        known, self._recalled = self._recalled, None
        self._map = SemanticMap(config.map) if known is None else known.semantic_map
        self._map.leave()
        self._memory = MemoryBuilder(config.memory, None if known is None else known.memory)
        self._panorama = Panorama(config.panorama, config.map.r_pcd)
        self._goal = GoalTracker(config.goal)
        if known is not None:
            self._goal.recall(known.semantic_map.view().objects, self._target)
        self._locomotion = Locomotion(config.locomotion, self._guide)
        self._barren = BarrenWaypoints(config.locomotion.recovery)
        self._odometry = Odometry()
        self._phase = Phase.EXPLORATION
        self._waypoint: NDArray[np.float64] | None = None
        self._looking_again = False
        self._look_steps = 0
        self._search = (
            None
            if config.search is None
            else PlannedSearch(
                self._target, self._vocabulary, config.search, config.locomotion, self._reasoner
            )
        )
        self._decisions = 0
        self._counsel.close()
        self._counsel = counsel(self._reasoner, PriorReasoner(), config.counsel)

    @property
    def knowledge(self) -> Knowledge:
        """The map and the memory by now."""
        return Knowledge(self._map, self._memory.memory)

    @property
    def way(self) -> NDArray[np.float64] | None:
        """(K, 2) the way that the last action is a part of; None where it was a turn to look."""
        return self._locomotion.way

    def recall(self, knowledge: Knowledge) -> None:
        """Start with an earlier episode's map and memory after the next `reset`."""
        self._recalled = knowledge

    def act(self, observation: Observation) -> Action:
        """The next action: one more view of the panorama, a step of the path, or stop."""
        seen = self._detector.detect(observation.rgb, self._vocabulary)
        detections = object_masks(observation, seen)
        update = self._map.integrate(observation, detections)  # Section III-C
        self._goal.observe(observation, detections, self._target)
        self._goal.forget(update.gone)
        self._odometry.add(observation)
        self._locomotion.observe(observation)
        if self._search is not None:
            self._search.observe(observation.world_from_base)
        looks_round = self._panorama.collecting
        if looks_round and self._panorama.add(observation, detections, update):
            return Action.TURN_LEFT
        view = self._map.view()
        if looks_round:
            self._decide(observation, view)
        elif self._must_reconsider(detections, view):
            self._decide_from_here(Frame(observation, detections, update, view))
        elif not self._looking_down:
            self._heed(observation, view)
        action = self._walk(observation, view)
        if action is None:  # at the waypoint, or as near as one gets: look around anew
            return self._look_round(Frame(observation, detections, update, view))
        return action

    def close(self) -> None:
        """Tell the listener that the episode is over."""
        view = self._map.view() if self._odometry.started else None
        self._counsel.close()
        self._listener.on_close(view, self._memory.memory)

    def _decide(self, observation: Observation, view: MapView) -> None:
        """At a waypoint: remember the place (III-D), ask the reasoner, choose p_target (III-E)."""
        self._locomotion.squeeze(False)
        reach = self._locomotion.reach(observation, view.grid)
        node = self._memory.arrive(
            self._odometry.position_xy, view, self._odometry.since_arrival_m, reach.geodesic
        )
        self._odometry.arrive()
        self._memory.refresh(view)
        query = Query(self._target, self._memory.snapshot(node), self._panorama.views(view))
        guidance = self._counsel.ask(query, observation.timestamp_s)
        self._asked = Asked(query, observation.world_from_camera)
        self._follow(guidance, observation, view, reach)

    def _decide_from_here(self, frame: Frame) -> None:
        """Decide on the current view alone."""
        self._panorama.begin(views=1)
        self._panorama.add(frame.observation, frame.detections, frame.update)
        self._decide(frame.observation, frame.view)

    def _look_round(self, frame: Frame) -> Action:
        """At the end of a walk: the first turn of a panorama, or a short look and the next walk."""
        if self._search is None:
            self._panorama.begin()
            self._panorama.add(frame.observation, frame.detections, frame.update)
            return Action.TURN_LEFT
        turn = self._search.look(frame.observation, frame.view, self._locomotion)
        if turn is not None:
            return turn
        self._decide_from_here(frame)
        # Where the walk ends at once, one more look from here lets the next step choose anew.
        return self._walk(frame.observation, frame.view) or Action.TURN_LEFT

    def _heed(self, observation: Observation, view: MapView) -> None:
        """Change course if the reasoner's own answer to the last question has come on the way."""
        guidance = self._counsel.late(observation.timestamp_s)
        if guidance is None:
            return
        if guidance.steers_as(self._guidance):
            self._memory.set_room(self._asked.query.memory.current, guidance.room_type)
            return
        reach = self._locomotion.reach(observation, view.grid)
        self._follow(guidance, observation, view, reach)

    def _follow(
        self, guidance: Guidance, observation: Observation, view: MapView, reach: CostField
    ) -> None:
        """Choose p_target by the guidance on the last question, and set out for it."""
        query, self._guidance = self._asked.query, guidance
        self._memory.set_room(query.memory.current, guidance.room_type)
        chosen = query.panorama[guidance.direction]
        self._goal.point(view, self._asked.world_from_camera, chosen.bearing)
        # The paper's condition: g_found = 1 and T_target in O; anything else explores on.
        self._looking_again = False
        acquiring = self._goal.recognised(guidance.target_found, view, self._target)
        self._phase = Phase.TARGET_ACQUISITION if acquiring else Phase.EXPLORATION
        affordances = None
        self._waypoint = self._plan(guidance, observation, view, reach)
        if self._waypoint is None:
            affordances = self._affordances(view, guidance)
            self._waypoint = self._choose(affordances, view, reach)
        path = np.zeros((0, 2))
        if self._waypoint is not None:
            self._locomotion.go_to(self._waypoint)
            path = self._locomotion.path(observation, view.grid)
        self._listener.on_decision(
            Decision(
                index=self._decisions,
                step=observation.step,
                phase=self._phase,
                waypoint=self._waypoint,
                path=path,
                map_view=view,
                memory=query.memory,
                guidance=guidance,
                affordances=affordances,
                panorama=query.panorama,
                frontiers=() if self._search is None else self._search.weighed,
                candidates=self._goal.candidates,
            )
        )
        self._decisions += 1

    def _plan(
        self, guidance: Guidance, observation: Observation, view: MapView, reach: CostField
    ) -> NDArray[np.float64] | None:
        """Where to go by the plan over frontiers, or to see the target; None to go by A."""
        if self._search is None:
            return None
        foot_z = float(observation.world_from_base.translation[2])
        off_stairs = self._search.step_off(foot_z, view, reach)
        if off_stairs is not None:
            return off_stairs
        admissible = self._barren.admissible(view.frontiers, self._decisions)
        if self._phase is Phase.EXPLORATION:
            guided = self._memory.frontier_points_of(guidance.node_id, view)[:, :2]
            glimpses = self._goal.pursue_glimpses(view)
            hints = Hints(guided, glimpses, self._goal.is_elsewhere(view))
            standing = Standing(
                foot_z, reach, lambda: self._squeezed(observation, view), admissible
            )
            waypoint = self._search.set_out(hints, standing, view)
            self._locomotion.squeeze(self._search.squeezes)
            if waypoint is None:
                places = self._memory.places(view.floor)
                waypoint = self._search.revisit(places, view, reach)
            if waypoint is not None or not self._goal.settle(view):
                return waypoint
            self._phase = Phase.TARGET_ACQUISITION
        self._search.leave()
        towards = self._towards_target(observation, view, reach, admissible)
        if towards is None:
            reach = self._squeezed(observation, view)
            towards = self._towards_target(observation, view, reach, admissible)
        return towards

    def _towards_target(
        self,
        observation: Observation,
        view: MapView,
        reach: CostField,
        admissible: NDArray[np.bool_],
    ) -> NDArray[np.float64] | None:
        """Where the target is seen from nearby, or the frontier by which it may be reached."""
        assert self._search is not None
        vantage = self._vantage(observation, view, reach)
        if vantage is not None:
            return vantage
        points = self._goal.points(view, self._target)
        return self._search.set_out_towards(points, view, reach, admissible)

    def _squeezed(self, observation: Observation, view: MapView) -> CostField:
        """Cost of walking to every cell, through gaps that may be too narrow, too."""
        self._locomotion.squeeze()
        return self._locomotion.reach(observation, view.grid)

    def _affordances(self, view: MapView, guidance: Guidance) -> Affordances:
        """A on M_nav, of the phase."""
        config = self.config.affordances
        s_dir = self._panorama.direction_points(guidance.direction)
        if self._phase is Phase.TARGET_ACQUISITION:
            return acquisition(view, s_dir, self._goal.points(view, self._target), config)
        s_node = self._memory.frontier_points_of(guidance.node_id, view)
        return exploration(view, s_dir, s_node, self._odometry.history, config)

    def _choose(
        self, affordances: Affordances, view: MapView, reach: CostField
    ) -> NDArray[np.float64] | None:
        """p_target among the points that can be walked to and have not just been tried in vain."""
        reachable = np.isfinite(reach.at(affordances.points[:, :2]))
        if self._search is not None:  # whether to take a flight is not for A to say
            on_floor = np.abs(affordances.points[:, 2] - view.floor_z) <= ON_FLIGHT_M
            reachable &= on_floor | ~(reachable & on_floor).any()
        fresh = self._barren.admissible(affordances.points, self._decisions)
        waypoint = select_waypoint(affordances, reachable & fresh)
        return waypoint if waypoint is not None else select_waypoint(affordances, reachable)

    def _walk(self, observation: Observation, view: MapView) -> Action | None:
        """A turn or step towards p_target, stop at the target; None when the walk has ended."""
        if self._waypoint is None:
            return self._stop()  # nothing left that can be reached: the search is over
        acquiring = self._phase is Phase.TARGET_ACQUISITION
        if self._looking_again:
            self._look_steps += 1
            if self._goal.accepted or self._look_steps > LONGEST_LOOK:
                self._looking_again = False
                return self._conclude(observation, view)
        if acquiring and not self._looking_again and self._at_target(observation, view):
            return self._conclude(observation, view)
        action = self._locomotion.next_action(observation, view.grid, view)
        if action is None and self._looking_again:
            return self._look_again(observation, view)
        if action is None and acquiring:
            action = self._close_in(observation, view)
            if action is None and self._at_target(observation, view, walk_ended=True):
                return self._conclude(observation, view)
        if action is None:  # do not choose the same spot again without having learnt anything
            self._barren.add(self._waypoint, self._decisions)
        return action

    def _at_target(
        self, observation: Observation, view: MapView, *, walk_ended: bool = False
    ) -> bool:
        """Whether this is near enough to stop."""
        eye = observation.world_from_camera
        return self._goal.reached(eye, view, self._target, walk_ended=walk_ended)

    def _conclude(self, observation: Observation, view: MapView) -> Action | None:
        """At what may be the target: stop, or look at it from a further side, or turn away."""
        if not self._goal.accepted:
            spot = self._further_side(observation, view)
            if spot is not None:
                self._goal.look_again(spot)
                self._looking_again, self._look_steps = True, 0
                self._waypoint = spot
                self._locomotion.go_to(spot)
                action = self._locomotion.next_action(observation, view.grid, view)
                return self._look_again(observation, view) if action is None else action
            if not self._goal.judge():
                self._phase = Phase.EXPLORATION
                return None
        if self._at_target(observation, view):
            return self._stop()
        action = self._close_in(observation, view)
        if action is None and self._at_target(observation, view, walk_ended=True):
            return self._stop()
        return action

    def _further_side(self, observation: Observation, view: MapView) -> NDArray[np.float64] | None:
        """Where to look at the candidate from next; None when it has been looked at enough."""
        if not self._goal.wants_another_look():
            return None
        reach = self._locomotion.reach(observation, view.grid)
        height = observation.world_from_camera.translation[2] - view.floor_z
        return further_look(self._goal, self._target, view, reach, height)

    def _look_again(self, observation: Observation, view: MapView) -> Action | None:
        """Face the candidate from a further side; then conclude anew."""
        candidate = self._goal.candidate
        if candidate is not None:
            action = self._locomotion.face(observation, candidate.center[:2])
            if action is not None:
                return action
        self._looking_again = False
        return self._conclude(observation, view)

    def _stop(self) -> Action:
        """The end of the search, but not before the reasoner has had its say."""
        return Action.TURN_LEFT if self._counsel.pending else Action.STOP

    def _close_in(self, observation: Observation, view: MapView) -> Action | None:
        """The last metre, where A_dir + A_sem peaks short of the target: go where it is seen."""
        if self._waypoint is not None and self._locomotion.progress is Progress.GAVE_UP:
            self._barren.add(self._waypoint, self._decisions)
        reach = self._locomotion.reach(observation, view.grid)
        vantage = self._vantage(observation, view, reach)
        if vantage is None:
            return None
        self._waypoint = vantage
        self._locomotion.go_to(vantage)
        return self._locomotion.next_action(observation, view.grid, view)

    def _vantage(
        self, observation: Observation, view: MapView, reach: CostField
    ) -> NDArray[np.float64] | None:
        """The nearest spot from which the target is seen as near as the stop rule asks."""
        return vantage_point(
            self._goal.points(view, self._target),
            self._goal,
            view,
            reach,
            observation.world_from_camera.translation[2] - view.floor_z,
            lambda spots: self._barren.admissible(spots, self._decisions),
        )

    def _must_reconsider(self, detections: Detections, view: MapView) -> bool:
        """Whether something on the way calls for a decision before the walk has ended."""
        if self._looking_down:
            return False
        return (
            self._sights_target(detections, view)
            or self._lost_target(view)
            or (self._search is not None and self._search.is_gone(view))
        )

    @property
    def _looking_down(self) -> bool:
        """Whether the camera is tilted for a moment."""
        return self._search is not None and self._search.looking_down

    def _lost_target(self, view: MapView) -> bool:
        """Whether what was gone to has turned out to be something else."""
        weighs = self.config.goal.evidence is not None
        acquiring = self._phase is Phase.TARGET_ACQUISITION
        return weighs and acquiring and not self._goal.is_mapped(view, self._target)

    def _sights_target(self, detections: Detections, view: MapView) -> bool:
        """Whether the target has just come into view on the way (preset `default`)."""
        return (
            self.config.decide_on_sight
            and self._phase is Phase.EXPLORATION
            and self._target in detections.labels
            and (self._goal.glimpsed or self._goal.is_mapped(view, self._target))
        )
