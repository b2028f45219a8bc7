"""Candidates for the target, each with the evidence for and against it from several sides.

One detection proves little: detectors take lookalikes for the target, their masks bleed onto what
stands before and behind, and they do so again in every frame from the same side. So a frame is no
vote of its own: all frames from one side and one range are one vote, a miss of something in plain
view counts against it, and a stop needs more than one side can say unless that is very sure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.ndimage import binary_erosion
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel
from toponav.geometry import back_project
from toponav.types import Detections, Observation

Positive = Annotated[float, Field(gt=0.0)]

SETTLED = 100.0
"""Log-odds that no evidence outweighs."""


class EvidenceConfig(ConfigModel):
    """What sightings weigh, in log-odds, and what is asked of a target."""

    prior: float = 0.0
    """Of something that was detected once, before that detection's score is known."""

    hit: float = 1.2
    """A side from which it is always detected, with a neutral score."""

    score_slope: float = 8.0
    """More for each 1 that the mean score exceeds the neutral one: right detections score about
    0.2 above wrong ones (docs/noise.md)."""

    neutral_score: float = 0.5
    """Score that speaks neither for nor against."""

    most_per_side: float = 2.5
    """No side says more than this, for or against."""

    miss: float = -0.8
    """A side from which it is plainly in view and never detected as anything."""

    other: float = -2.0
    """A side from which it is always detected as something else."""

    other_overlap: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    """Share of its points that a detection of something else must cover to count."""

    steadiness: Annotated[float, Field(ge=0.0)] = 1.0
    """Frames from one side that make its word count half of what many frames would."""

    far_weight: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    """What a look from beyond `near_m` counts, against one from nearer by."""

    near_m: Positive = 2.5
    """A look from this near is a good one, metres."""

    lead: float = -0.4
    """From here on a candidate is worth going to."""

    accept: float = 2.0
    """From here on it is the target."""

    probable: float = 0.5
    """Enough where no further side can be looked at."""

    last_resort: float = -3.5
    """Enough where nothing is left to explore: a detector that misses an object in most frames
    never says enough for it, and who stops nowhere has found nothing."""

    rejection: float = -3.0
    """Added when all looks are spent: only much new evidence reopens the case."""

    looks: Annotated[int, Field(ge=0)] = 3
    """Further sides that are looked at before the verdict."""

    sides: Annotated[int, Field(ge=1)] = 8
    """Directions of view round a candidate that count as different."""

    voxel_m: Positive = 0.05
    """Points of a candidate are this far apart."""

    gap_m: Positive = 0.12
    """Points this near belong to one object."""

    overlap: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """Share of a detection's points that must lie on a candidate to be one more sighting of it."""

    visible_share: Annotated[float, Field(gt=0.0, le=1.0)] = 0.4
    """Share of a candidate's points that must be in view for a look at it."""

    kept_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    """A point that fewer of the masks cover, where it is in view, bled into it."""

    depth_tolerance_m: Positive = 0.15
    """A point is in view where the image is as deep as it is far, so exactly."""


@dataclass
class Look:
    """All frames from one side and range.

    Attributes:
        frames: In which the candidate was plainly in view.
        hits: In which it was detected.
        others: In which something else was detected there, and not the target.
        score: Sum of the detections' scores.
        weight: What the look counts.
    """

    weight: float
    frames: int = 0
    hits: int = 0
    others: int = 0
    score: float = 0.0

    def log_odds(self, config: EvidenceConfig) -> float:
        """What it says."""
        mean_score = self.score / self.hits if self.hits else 0.0
        found = config.hit + config.score_slope * (mean_score - config.neutral_score)
        missed = self.frames - self.hits - self.others
        said = self.hits * found + self.others * config.other + missed * config.miss
        mean = min(max(said / self.frames, -config.most_per_side), config.most_per_side)
        return self.weight * mean * self.frames / (self.frames + config.steadiness)


@dataclass(eq=False)
class Candidate:
    """One thing that may be the target.

    Attributes:
        points: (N, 3) where it is, world frame, metres.
        seen: (N,) in how many frames each point was in view while the candidate was detected.
        hit: (N,) in how many of them it was in a mask of the target.
        looks: By side and range.
        verdict: Log-odds of earlier verdicts on it.
        returns: How often it was looked at again before a verdict.
        lost: Points that have gone since.
    """

    points: NDArray[np.float64]
    seen: NDArray[np.int64]
    hit: NDArray[np.int64]
    looks: dict[tuple[int, bool], Look] = field(default_factory=dict)
    verdict: float = 0.0
    returns: int = 0
    lost: int = 0

    def keep(self, rows: NDArray[np.bool_]) -> None:
        """Keep some of its points."""
        self.points, self.seen, self.hit = self.points[rows], self.seen[rows], self.hit[rows]

    @property
    def center(self) -> NDArray[np.float64]:
        """(3,) the middle of its points."""
        middle: NDArray[np.float64] = self.points.mean(axis=0)
        return middle

    def distance_from(self, here: NDArray[np.float64]) -> float:
        """From (2 or 3,) here to the nearest of its points, horizontally, metres."""
        return float(np.hypot(*(self.points[:, :2] - here[:2]).T).min())

    def seen_odds(self, config: EvidenceConfig) -> float:
        """What all looks at it say, whatever was made of that."""
        return config.prior + sum(look.log_odds(config) for look in self.looks.values())

    def log_odds(self, config: EvidenceConfig) -> float:
        """All that speaks for and against it, earlier verdicts too."""
        return self.seen_odds(config) + self.verdict

    def own_points(self, config: EvidenceConfig) -> NDArray[np.float64]:
        """(M, 3) the points that masks agree on."""
        kept: NDArray[np.float64] = self.points[self.hit >= config.kept_share * self.seen]
        return kept


@dataclass(frozen=True)
class SideView:
    """What one side says of a candidate, for those who watch.

    Attributes:
        side: Direction of view round the candidate, 0-based, counter-clockwise from -x.
        near: Whether it was seen from nearby.
        frames: In which it was plainly in view.
        hits: In which it was detected.
        others: In which something else was detected there.
        log_odds: What that says.
    """

    side: int
    near: bool
    frames: int
    hits: int
    others: int
    log_odds: float


@dataclass(frozen=True)
class CandidateView:
    """One candidate at a decision, for those who watch.

    Attributes:
        low: Lower corner (x, y, z) of its points, world frame, metres.
        high: Upper corner.
        log_odds: All that speaks for and against it.
        verdict: What of that earlier verdicts say.
        returns: How often it was looked at again.
        chosen: Whether it is gone to.
        sides: What each side and range says.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    log_odds: float
    verdict: float
    returns: int
    chosen: bool
    sides: tuple[SideView, ...]


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
                self._candidates.append(_fresh(everything[piece == number]))

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

    def near_sides(self, candidate: Candidate) -> frozenset[int]:
        """The sides from which it has been looked at from nearby."""
        return frozenset(side for side, near in candidate.looks if near)

    def observe(self, observation: Observation, detections: Detections) -> None:
        """Take the evidence of one frame."""
        own = np.array([label == self._target for label in detections.labels], dtype=np.bool_)
        for mask in detections.masks[own]:
            self._sight(observation, mask)
        for candidate in self._candidates:
            self._look(candidate, observation, detections, own)

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
            self._candidates.append(_fresh(points))
            return
        first = own[0]
        for other in own[1:]:
            _join(first, other)
            self._candidates.remove(other)
        distance, _ = cKDTree(first.points).query(points)
        _join(first, _fresh(points[distance > self._config.voxel_m]))

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
        look = candidate.looks.setdefault((self.side_of(candidate, eye), near), Look(weight))
        look.frames += 1
        if hits.any():
            look.hits += 1
            look.score += float(detections.scores[hits].max())
        elif (~is_target & (covered >= self._config.other_overlap)).any():
            look.others += 1

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


def view_of(candidate: Candidate, config: EvidenceConfig, *, chosen: bool) -> CandidateView:
    """What there is to show of a candidate."""
    points = candidate.own_points(config)
    points = points if len(points) else candidate.points
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return CandidateView(
        low=tuple(low),
        high=tuple(high),
        log_odds=candidate.log_odds(config),
        verdict=candidate.verdict,
        returns=candidate.returns,
        chosen=chosen,
        sides=tuple(
            SideView(side, near, look.frames, look.hits, look.others, look.log_odds(config))
            for (side, near), look in sorted(candidate.looks.items())
        ),
    )


def _chance(log_odds: float) -> float:
    """The probability that log-odds stand for."""
    return 1.0 / (1.0 + math.exp(-log_odds))


def _fresh(points: NDArray[np.float64]) -> Candidate:
    """A candidate that no look has been taken at."""
    none = np.zeros(len(points), np.int64)
    return Candidate(points, none, none.copy())


def _join(first: Candidate, other: Candidate) -> None:
    """Add the points and looks of another candidate to the first."""
    first.points = np.concatenate([first.points, other.points])
    first.seen = np.concatenate([first.seen, other.seen])
    first.hit = np.concatenate([first.hit, other.hit])
    first.verdict = min(first.verdict, other.verdict)
    first.returns = max(first.returns, other.returns)
    for key, look in other.looks.items():
        mine = first.looks.setdefault(key, Look(look.weight))
        mine.frames += look.frames
        mine.hits += look.hits
        mine.others += look.others
        mine.score += look.score


def _thinned(points: NDArray[np.float64], voxel_m: float) -> NDArray[np.float64]:
    """One point a voxel."""
    _, first = np.unique(np.floor(points / voxel_m).astype(np.int64), axis=0, return_index=True)
    thin: NDArray[np.float64] = points[np.sort(first)]
    return thin
