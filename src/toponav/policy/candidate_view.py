"""What there is to show of a candidate for the target."""

from __future__ import annotations

from dataclasses import dataclass

from toponav.policy.candidate import Candidate, EvidenceConfig


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
