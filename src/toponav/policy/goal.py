"""The target in the map: is it there, where is it, and when to stop (Section III-E)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel
from toponav.geometry import Pose
from toponav.mapping.view import MapView, PointCloud
from toponav.policy.candidate import SETTLED, Candidate, EvidenceConfig
from toponav.policy.candidate_view import CandidateView, view_of
from toponav.policy.evidence import TargetEvidence
from toponav.policy.glimpses import Glimpse, GlimpseConfig, Glimpses
from toponav.policy.sight import Metres, SightConfig, TargetSight
from toponav.types import Detections, Observation


class GoalConfig(ConfigModel):
    """When the target counts as mapped, and when the agent stops."""

    recognition: Literal["both", "reasoner", "detector"] = "both"
    """Who recognises the target: the paper asks both; one alone is its Table II. Without the
    detector the target is taken to be what stands nearest in the view that the reasoner chose."""

    pointed_width_deg: Annotated[float, Field(gt=0.0, le=180.0)] = 30.0
    """Without the detector: the middle of the chosen view in which the target is looked for."""

    pointed_depth_m: Metres = 0.5
    """Without the detector: how far behind its nearest point the target may reach."""

    min_points: Annotated[int, Field(ge=1)] = 4
    """Voxels of M_obj[target] before T_target counts as a member of O: one stray pixel is none."""

    dense_radius_m: Metres = 0.15
    """A point of the target counts when enough others are this near: three voxels of 0.05 m."""

    dense_neighbors: Annotated[int, Field(ge=0)] = 3
    """How many others; 0 keeps stray points."""

    stop_distance_m: Metres = 0.8
    """Stop within this horizontal distance of the target's cloud: the benchmark's viewpoints lie
    within 1 m of the object's surface, and depth is noisy."""

    farthest_stop_m: Metres = 1.0
    """Stop within this distance where the agent gets no nearer: the benchmark's 1 m."""

    min_height_m: float = 0.05
    """Lower points are floor that bled into the mask, unless the target is as flat as a rug."""

    depth_below_floor_m: Annotated[float, Field(ge=0.0)] = 0.15
    """How far below the floor a flat target's points may lie: half the floor's band."""

    max_height_m: float = 2.5
    """Points higher than this above the floor belong to the next storey."""

    sight: SightConfig = Field(default_factory=SightConfig)
    """What hides the target."""

    evidence: EvidenceConfig | None = None
    """Weigh what speaks for and against each candidate; without it, as in the paper, whatever the
    map holds under the target's name is the target."""

    glimpses: GlimpseConfig | None = None
    """Follow sightings of the target beyond the range of the depth camera."""


class GoalTracker:
    """Answers for S_sem, the target's part of the map.

    Without evidence its only state is where the reasoner has pointed, for the ablation without a
    detector; with it, the candidates and which of them is gone to.
    """

    def __init__(self, config: GoalConfig) -> None:
        """Take the thresholds."""
        self.config = config
        self._pointed = np.zeros((0, 3), dtype=np.float32)
        self._evidence: TargetEvidence | None = None
        self._chosen: Candidate | None = None
        self._glimpses: Glimpses | None = None
        self._foot = np.zeros(3)

    def observe(self, observation: Observation, detections: Detections, target: str) -> None:
        """Take the evidence of one frame."""
        self._foot = observation.world_from_base.translation
        if self.config.glimpses is not None:
            if self._glimpses is None:
                self._glimpses = Glimpses(self.config.glimpses, target)
            self._glimpses.observe(observation, detections)
        if self.config.evidence is not None:
            if self._evidence is None:
                self._evidence = TargetEvidence(self.config.evidence, target)
            self._evidence.observe(observation, detections)

    def forget(self, gone: NDArray[np.floating]) -> None:
        """Take what has gone from the map, (N, 3), out of what may be the target."""
        if self._evidence is not None:
            self._evidence.forget(gone)

    def recall(self, objects: Mapping[str, PointCloud], target: str) -> None:
        """Begin with the instances of the target that an earlier search has mapped."""
        if self.config.evidence is not None and target in objects:
            self._evidence = TargetEvidence(self.config.evidence, target)
            self._evidence.expect(objects[target].points)

    def is_elsewhere(self, view: MapView) -> bool:
        """Whether what may be the target has been seen, on another storey."""
        if self.config.evidence is None or self._evidence is None:
            return False
        leads, config = self._evidence.leads(self._foot), self.config.evidence
        return bool(leads) and not any(len(self._on_storey(c, config, view)) for c in leads)

    @property
    def glimpsed(self) -> bool:
        """Whether the last frame showed the target at a new place, too far off to be measured."""
        return self._glimpses is not None and self._glimpses.fresh

    def pursue_glimpses(self, view: MapView) -> tuple[Glimpse, ...]:
        """Glimpses of the target on the current storey that are worth one more decision."""
        return () if self._glimpses is None else self._glimpses.pursue(view.floor_z)

    @property
    def candidate(self) -> Candidate | None:
        """The candidate that is gone to; None without any, or without evidence."""
        return self._chosen

    @property
    def candidates(self) -> tuple[CandidateView, ...]:
        """All candidates as they stand, the rejected ones too; none without evidence."""
        config = self.config.evidence
        if config is None or self._evidence is None:
            return ()
        found = self._evidence.candidates
        return tuple(view_of(one, config, chosen=one is self._chosen) for one in found)

    def wants_another_look(self) -> bool:
        """Whether what is gone to is to be looked at from a further side before a verdict."""
        config, chosen = self.config.evidence, self._chosen
        return config is not None and chosen is not None and chosen.returns < config.looks

    def look_again(self, spot: NDArray[np.float64]) -> None:
        """Note that what is gone to is looked at once more, from a (2 or 3,) spot."""
        if self._chosen is not None:
            self._chosen.returns += 1
            self._chosen.note_eye(spot)

    def looked_from(self, eye: NDArray[np.float64]) -> bool:
        """Whether what is gone to has been looked at from nearby and the direction of an eye."""
        if self._evidence is None or self._chosen is None:
            return True
        return self._evidence.looked_from(self._chosen, eye)

    def judge(self) -> bool:
        """The verdict where no further side can be looked at: whether it is the target."""
        if self.config.evidence is None or self._evidence is None or self._chosen is None:
            return True
        if self._chosen.log_odds(self.config.evidence) >= self.config.evidence.probable:
            self._evidence.accept(self._chosen)
            return True
        self._evidence.reject(self._chosen)
        self._chosen = None
        return False

    def settle(self, view: MapView) -> bool:
        """Take the likeliest candidate of this storey for the target, as nothing else is left.

        One that was turned away from may still be the likeliest of all: a verdict says that more
        was asked for than was seen, and now no more is to be had.

        Returns:
            Whether there is one that is likely enough.
        """
        config = self.config.evidence
        if config is None or self._evidence is None:
            return False
        here = [c for c in self._evidence.candidates if len(self._on_storey(c, config, view))]
        if any(candidate.verdict >= SETTLED / 2.0 for candidate in here):
            return False
        odds = [(candidate.seen_odds(config), candidate) for candidate in here]
        best = max(odds, key=lambda pair: pair[0], default=None)
        if best is None or best[0] < config.last_resort:
            return False
        self._evidence.settle(best[1])
        return True

    @property
    def accepted(self) -> bool:
        """Whether what is gone to is the target, as far as can be told; always without evidence."""
        if self.config.evidence is None:
            return True
        odds = -math.inf if self._chosen is None else self._chosen.log_odds(self.config.evidence)
        return odds >= self.config.evidence.accept

    def recognised(self, target_found: bool, view: MapView, target: str) -> bool:
        """Whether to acquire the target: g_found = 1 and T_target in O, or the one that is asked.

        Args:
            target_found: g_found of the reasoner.
            view: The map.
            target: What is looked for.
        """
        asked = self.config.recognition
        by_reasoner = target_found or asked == "detector" or self.config.evidence is not None
        return by_reasoner and self.is_mapped(view, target)

    def point(self, view: MapView, eye: Pose, bearing: float) -> None:
        """Note where the reasoner sees the target; it counts only where there is no detector.

        Args:
            view: The map.
            eye: The camera, where the view was taken.
            bearing: World yaw of the chosen view, radians.
        """
        config = self.config
        if config.recognition != "reasoner":
            return
        obstacles = view.obstacles.points
        offset = obstacles[:, :2] - eye.translation[:2]
        turn = np.arctan2(offset[:, 1], offset[:, 0]) - bearing
        off_axis = np.abs((turn + np.pi) % math.tau - np.pi)
        ahead = off_axis <= math.radians(config.pointed_width_deg) / 2.0
        distance = np.hypot(offset[:, 0], offset[:, 1])
        nearest = distance[ahead].min(initial=math.inf)
        self._pointed = obstacles[ahead & (distance <= nearest + config.pointed_depth_m)]

    def points(self, view: MapView, target: str) -> NDArray[np.float32]:
        """S_sem: (N, 3) points of M_obj[target] within the current storey, without strays."""
        config = self.config
        if config.recognition == "reasoner":
            return self._pointed
        if self.config.evidence is not None:
            return self._candidate_points(self.config.evidence, view)
        cloud = view.objects.get(target)
        if cloud is None:
            return np.zeros((0, 3), dtype=np.float32)
        height = cloud.points[:, 2] - view.floor_z
        below_ceiling = height < config.max_height_m
        raised = self._dense(cloud.points[below_ceiling & (height > config.min_height_m)])
        if len(raised) >= config.min_points:
            return raised
        return self._dense(cloud.points[below_ceiling & (height > -config.depth_below_floor_m)])

    def is_mapped(self, view: MapView, target: str) -> bool:
        """Whether T_target is in O."""
        return len(self.points(view, target)) >= self.config.min_points

    def reached(
        self, world_from_camera: Pose, view: MapView, target: str, *, walk_ended: bool = False
    ) -> bool:
        """Whether the agent stands close enough to the target and sees it.

        The distance alone is not enough: the target may stand behind a wall.

        Args:
            world_from_camera: The camera.
            view: The map.
            target: What is looked for.
            walk_ended: The agent gets no nearer, so `farthest_stop_m` is close enough.
        """
        points = self.points(view, target)
        if len(points) < self.config.min_points:
            return False
        limit = self.config.farthest_stop_m if walk_ended else self.config.stop_distance_m
        here = world_from_camera.translation
        if np.hypot(points[:, 0] - here[0], points[:, 1] - here[1]).min() > limit:
            return False  # sight need not be looked into
        sight = TargetSight(points, view.scene.points, limit, self.config.sight)
        return sight.within_reach(here, limit)

    def _candidate_points(self, config: EvidenceConfig, view: MapView) -> NDArray[np.float32]:
        """Those of the candidate that is gone to: it stays the same while it is a lead."""
        leads = [] if self._evidence is None else self._evidence.leads(self._foot)
        here = [lead for lead in leads if len(self._on_storey(lead, config, view))]
        sure = [lead for lead in here if lead.log_odds(config) >= config.accept]
        if self._chosen not in here or (sure and self._chosen not in sure):
            self._chosen = here[0] if here else None
        if self._chosen is None:
            return np.zeros((0, 3), dtype=np.float32)
        return self._on_storey(self._chosen, config, view)

    def _on_storey(
        self, candidate: Candidate, config: EvidenceConfig, view: MapView
    ) -> NDArray[np.float32]:
        """(N, 3) a candidate's points within the current storey; none where they are too few."""
        points = candidate.own_points(config)
        height = points[:, 2] - view.floor_z
        low = -self.config.depth_below_floor_m
        inside = points[(height > low) & (height < self.config.max_height_m)]
        enough = len(inside) >= self.config.min_points
        return (inside if enough else inside[:0]).astype(np.float32)

    def _dense(self, points: NDArray[np.float32]) -> NDArray[np.float32]:
        """The points with enough others around them."""
        k = self.config.dense_neighbors
        if len(points) <= k:
            return points[:0]
        distance, _ = cKDTree(points).query(points, k=[k + 1])  # the point itself is the first
        dense: NDArray[np.float32] = points[distance[:, 0] <= self.config.dense_radius_m]
        return dense
