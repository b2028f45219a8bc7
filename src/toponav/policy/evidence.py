"""Candidates for the target, each with the evidence for and against it from several sides.

One detection proves little: detectors take lookalikes for the target, their masks bleed onto what
stands before and behind, and they do so again in every frame from the same side. So a frame is no
vote of its own: all frames from one side and one range are one vote, a miss of something in plain
view counts against it, and a stop needs more than one side can say unless that is very sure.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from toponav.geometry import back_project
from toponav.policy.candidate import SETTLED, Candidate, EvidenceConfig, Look
from toponav.policy.plausibility import implausibilities
from toponav.types import Detections, Observation


class TargetEvidence:
    """The candidates for one target."""

    def __init__(self, config: EvidenceConfig, target: str) -> None:
        """Know of none yet."""
        self._config = config
        self._target = target
        self._candidates: list[Candidate] = []

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All of them, the rejected ones too, in order of appearance."""
        return tuple(self._candidates)

    def leads(self, here: NDArray[np.float64]) -> list[Candidate]:
        """Those worth going to from (2 or 3,) here; first what is likeliest for its distance."""
        config = self._config
        rated = [(c.log_odds(config), c) for c in self._candidates]
        worth = [
            (_chance(odds) / (c.distance_from(here) + config.near_m), c)
            for odds, c in rated
            if odds >= config.lead
        ]
        return [c for _, c in sorted(worth, key=lambda pair: -pair[0])]

    def expect(self, points: NDArray[np.floating]) -> None:
        """Take each connected piece of (N, 3) points for a candidate, to be looked at again."""
        if len(points):
            everything = np.asarray(points, np.float64)
            piece = _pieces(everything, self._config.gap_m)
            for number in range(piece.max() + 1):
                self._candidates.append(Candidate.of(everything[piece == number]))

    def forget(self, gone: NDArray[np.floating]) -> None:
        """Take what has gone, (N, 3), out of the candidates, and those of which little is left."""
        if not len(gone):
            return
        tree = cKDTree(gone)
        kept = []
        for candidate in self._candidates:
            away, _ = tree.query(candidate.points)
            left = away > math.sqrt(3.0) * self._config.voxel_m
            candidate.lost += int((~left).sum())
            candidate.keep(left)
            if len(candidate.points) > candidate.lost:
                kept.append(candidate)
        self._candidates = kept

    def accept(self, candidate: Candidate) -> None:
        """Take it for the target from now on."""
        missing = self._config.accept - candidate.log_odds(self._config)
        candidate.verdict += max(0.0, missing)

    def settle(self, candidate: Candidate) -> None:
        """Take it for the target whatever further looks say."""
        candidate.verdict += SETTLED

    def reject(self, candidate: Candidate) -> None:
        """Take it for something else, unless much speaks for it later."""
        candidate.verdict += self._config.rejection
        candidate.returns = 0

    def looked_from(self, candidate: Candidate, eye: NDArray[np.float64]) -> bool:
        """Whether it has been looked at, or was to be, from the direction of a (2,) or (3,) eye."""
        if not candidate.eyes:
            return False
        center = candidate.center[:2]
        offset = np.array(candidate.eyes) - center
        bearings = np.arctan2(offset[:, 1], offset[:, 0])
        bearing = math.atan2(eye[1] - center[1], eye[0] - center[0])
        apart = np.abs((bearings - bearing + math.pi) % math.tau - math.pi)
        return bool(apart.min() < math.radians(self._config.new_side_deg))

    def observe(self, observation: Observation, detections: Detections) -> None:
        """Take the evidence of one frame."""
        own = np.array([label == self._target for label in detections.labels], dtype=np.bool_)
        for mask in detections.masks[own]:
            self._sight(observation, mask)
        for candidate in self._candidates:
            self._look(candidate, observation, detections, own)
        self._give_up_settled()

    def _give_up_settled(self) -> None:
        """Drop what was settled on if something likelier has come into view since."""
        config = self._config
        if config.better is None:
            return
        settled = [c for c in self._candidates if c.verdict >= SETTLED / 2.0]
        if not settled:
            return
        odds = max(candidate.seen_odds(config) for candidate in settled) + config.better
        fresh = (c for c in self._candidates if c not in settled)
        if any(c.seen_odds(config) >= odds and c.log_odds(config) >= config.lead for c in fresh):
            for candidate in settled:
                candidate.verdict -= SETTLED

    def side_of(self, candidate: Candidate, eye: NDArray[np.float64]) -> int:
        """The side from which a (2,) or (3,) eye looks at a candidate."""
        x, y = (eye[:2] - candidate.center[:2]).tolist()
        turn = (math.atan2(y, x) + math.pi) / math.tau
        return int(turn * self._config.sides) % self._config.sides

    def _sight(self, observation: Observation, mask: NDArray[np.bool_]) -> None:
        """A detection: more of a candidate, or a new one."""
        points = self._object_points(observation, mask)
        if not len(points):
            return
        own = []
        for candidate in self._candidates:
            distance, _ = cKDTree(candidate.points).query(points)
            if float((distance <= self._config.gap_m).mean()) >= self._config.overlap:
                own.append(candidate)
        if not own:
            self._candidates.append(Candidate.of(points))
            return
        first = own[0]
        for other in own[1:]:
            first.join(other)
            self._candidates.remove(other)
        distance, _ = cKDTree(first.points).query(points)
        first.join(Candidate.of(points[distance > self._config.voxel_m]))

    def _object_points(
        self, observation: Observation, mask: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """(N, 3) the largest connected piece of what a mask shows, without its edge."""
        width = max(1, round(observation.depth.shape[1] / 320))
        inner = binary_erosion(mask, iterations=width)
        kept = (inner if inner.any() else mask) & (observation.depth > 0.0)
        if not kept.any():
            return np.zeros((0, 3))
        in_camera = back_project(observation.depth, observation.intrinsics)[kept]
        points = _thinned(observation.world_from_camera.apply(in_camera), self._config.voxel_m)
        piece = _pieces(points, self._config.gap_m)
        largest: NDArray[np.float64] = points[piece == np.bincount(piece).argmax()]
        return largest

    def _look(
        self,
        candidate: Candidate,
        observation: Observation,
        detections: Detections,
        is_target: NDArray[np.bool_],
    ) -> None:
        """Whether the frame shows a candidate, and what was detected there."""
        visible, row, column = self._in_view(candidate.points, observation)
        if not visible.any():
            return
        on = detections.masks[:, row[visible], column[visible]]
        own = candidate.hit >= self._config.kept_share * candidate.seen
        covered = on[:, own[visible]].mean(axis=1) if own[visible].any() else np.zeros(len(on))
        hits = is_target & (covered >= self._config.overlap)
        if hits.any():
            candidate.seen[visible] += 1
            candidate.hit[visible] += on[is_target].any(axis=0)
        if (visible & own).sum() < self._config.visible_share * max(own.sum(), 1):
            return
        eye = observation.world_from_camera.translation
        near = bool(np.hypot(*(candidate.center - eye)[:2]) <= self._config.near_m)
        weight = 1.0 if near else self._config.far_weight
        if near:
            candidate.implausible = implausibilities(
                candidate.own_points(self._config),
                float(observation.world_from_base.translation[2]),
                self._target,
                all_round=candidate.near_sides() > 1,
            )
            candidate.note_eye(eye)
        others = ~is_target & (covered >= self._config.other_overlap)
        if not hits.any() and others.any():
            names = {detections.labels[row] for row in np.flatnonzero(others)}
            if all(self._cannot_be(candidate, name, observation) for name in names):
                return
        look = candidate.looks.setdefault((self.side_of(candidate, eye), near), Look(weight))
        look.frames += 1
        if hits.any():
            look.hits += 1
            look.score += float(detections.scores[hits].max())
        elif others.any():
            look.others += 1

    def _cannot_be(self, candidate: Candidate, name: str, observation: Observation) -> bool:
        """Whether its shape rules out what a candidate is called."""
        if not self._config.impossible_names:
            return False
        foot_z = float(observation.world_from_base.translation[2])
        points = candidate.own_points(self._config)
        return implausibilities(points, foot_z, name, all_round=False) > 0

    def _in_view(
        self, points: NDArray[np.float64], observation: Observation
    ) -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]:
        """(N,) whether each point is in the image and not hidden, and its row and column there."""
        camera, depth = observation.intrinsics, observation.depth
        x, y, z = observation.world_from_camera.inverse().apply(points).T
        ahead = z > 0.1
        safe_z = np.where(ahead, z, 1.0)
        column = np.rint(camera.fx * x / safe_z + camera.cx).astype(np.int64)
        row = np.rint(camera.fy * y / safe_z + camera.cy).astype(np.int64)
        inside = ahead & (row >= 0) & (row < camera.height)
        inside &= (column >= 0) & (column < camera.width)
        row, column = np.where(inside, row, 0), np.where(inside, column, 0)
        visible = inside & (np.abs(depth[row, column] - z) <= self._config.depth_tolerance_m)
        return visible, row, column


def _pieces(points: NDArray[np.float64], gap_m: float) -> NDArray[np.int64]:
    """(N,) the connected piece of each of (N, 3) points, from 0 on."""
    pairs = cKDTree(points).query_pairs(gap_m, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, piece = connected_components(links, directed=False)
    return np.asarray(piece, np.int64)


def _chance(log_odds: float) -> float:
    """The probability that log-odds stand for."""
    return 1.0 / (1.0 + math.exp(-log_odds))


def _thinned(points: NDArray[np.float64], voxel_m: float) -> NDArray[np.float64]:
    """One point a voxel."""
    _, first = np.unique(np.floor(points / voxel_m).astype(np.int64), axis=0, return_index=True)
    thin: NDArray[np.float64] = points[np.sort(first)]
    return thin
