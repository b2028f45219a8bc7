"""One thing that may be the target, and what the looks at it say."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel

Positive = Annotated[float, Field(gt=0.0)]

SETTLED = 100.0
"""Log-odds that no evidence outweighs."""

SAME_PLACE_M = 0.2
"""Looks from places this near to each other are taken from one."""


class EvidenceConfig(ConfigModel):
    """What sightings weigh, in log-odds, and what is asked of a target."""

    prior: float = 0.0
    """Of something that was detected once, before that detection's score is known."""

    hit: float = 1.0
    """A side from which it is always detected, with a neutral score."""

    score_slope: float = 12.0
    """More for each 1 that the mean score exceeds the neutral one: right detections score about
    0.2 above wrong ones (docs/noise.md)."""

    neutral_score: float = 0.5
    """Score that speaks neither for nor against."""

    most_per_side: float = 2.5
    """No side says more than this, for or against."""

    miss: float = -0.65
    """A side from which it is plainly in view and never detected as anything."""

    other: float = -2.0
    """A side from which it is always detected as something else."""

    other_overlap: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    """Share of its points that a detection of something else must cover to count."""

    implausible: float = -2.5
    """Each way in which its shape, seen from nearby, is none of the target's kind."""

    implausible_most: float = 0.5
    """Such a thing is no likelier than this, however sure a detector is of it from all sides: it is
    sure of the same thing each time. Enough to be looked at, not to be stopped at."""

    impossible_names: bool = True
    """A frame in which it is called what its shape rules out tells nothing: not whether it is the
    target, and not that it is none. Detectors call sofas beds more often than not."""

    better: float | None = 1.0
    """What was settled on as nothing else was left is given up for something that so much more
    speaks for; None sticks to it."""

    steadiness: Annotated[float, Field(ge=0.0)] = 0.5
    """Frames from one side that make its word count half of what many frames would."""

    far_weight: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    """What a look from beyond `near_m` counts, against one from nearer by."""

    near_m: Positive = 2.5
    """A look from this near is a good one, metres."""

    lead: float = -0.4
    """From here on a candidate is worth going to."""

    accept: float = 2.0
    """From here on it is the target."""

    probable: float = 1.0
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

    new_side_deg: Annotated[float, Field(gt=0.0, le=180.0)] = 40.0
    """Another look is taken from a direction that differs so much from all earlier ones."""

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
        eyes: Places (x, y) from which it was looked at from nearby, or was to be.
        implausible: In how many ways it is unlike a thing of the target's kind, seen from nearby.
    """

    points: NDArray[np.float64]
    seen: NDArray[np.int64]
    hit: NDArray[np.int64]
    looks: dict[tuple[int, bool], Look] = field(default_factory=dict)
    verdict: float = 0.0
    returns: int = 0
    lost: int = 0
    eyes: list[tuple[float, float]] = field(default_factory=list)
    implausible: int = 0

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
        """What its shape and all looks at it say, whatever was made of that."""
        shape = config.prior + config.implausible * self.implausible
        odds = shape + sum(look.log_odds(config) for look in self.looks.values())
        return min(odds, config.implausible_most) if self.implausible else odds

    def log_odds(self, config: EvidenceConfig) -> float:
        """All that speaks for and against it, earlier verdicts too."""
        return self.seen_odds(config) + self.verdict

    def own_points(self, config: EvidenceConfig) -> NDArray[np.float64]:
        """(M, 3) the points that masks agree on."""
        kept: NDArray[np.float64] = self.points[self.hit >= config.kept_share * self.seen]
        return kept

    @classmethod
    def of(cls, points: NDArray[np.float64]) -> Candidate:
        """One at (N, 3) points that no look has been taken at."""
        none = np.zeros(len(points), np.int64)
        return cls(points, none, none.copy())

    def join(self, other: Candidate) -> None:
        """Add the points and looks of another."""
        self.points = np.concatenate([self.points, other.points])
        self.seen = np.concatenate([self.seen, other.seen])
        self.hit = np.concatenate([self.hit, other.hit])
        self.verdict = max(self.verdict, other.verdict, key=abs)
        self.returns = max(self.returns, other.returns)
        if other.looks:  # of mere points no shape has been judged
            self.implausible = min(self.implausible, other.implausible)
        for eye in other.eyes:
            self.note_eye(np.array(eye))
        for key, look in other.looks.items():
            mine = self.looks.setdefault(key, Look(look.weight))
            mine.frames += look.frames
            mine.hits += look.hits
            mine.others += look.others
            mine.score += look.score

    def near_sides(self) -> int:
        """The number of sides from which it was detected from nearby."""
        return sum(near and look.hits > 0 for (_, near), look in self.looks.items())

    def note_eye(self, eye: NDArray[np.float64]) -> None:
        """Note from where, (2 or 3,), it is looked at from nearby, or was to be."""
        place = (float(eye[0]), float(eye[1]))
        if all(math.dist(place, known) >= SAME_PLACE_M for known in self.eyes):
            self.eyes.append(place)
