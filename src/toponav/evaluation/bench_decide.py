"""What a decision costs, in a small building and in a large one."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.config import NavigatorConfig
from toponav.evaluation.bench_tour import Tour, TourFrame
from toponav.navigator import Navigator
from toponav.policy.decision import Decision, Listeners
from toponav.reasoning import PriorReasoner
from toponav.types import Detections

WARM_UP_STOPS = 2
"""Stops before the clock counts: the first ones compile."""

DECISION_TARGET = "toilet"
"""No room of the tour has one, so that every decision explores."""


class _KnownDetections:
    """Tells what is known of a frame already, so that detection costs nothing."""

    def __init__(self) -> None:
        self.next: Detections | None = None

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """What has been set as `next`."""
        assert self.next is not None
        return self.next


class _Count(Listeners):
    """Counts decisions."""

    def __init__(self) -> None:
        super().__init__()
        self.decisions = 0

    def on_decision(self, decision: Decision) -> None:
        """One more."""
        self.decisions += 1


def bench_decide(
    config: NavigatorConfig, small_m2: float, large_m2: float, size: tuple[int, int], timed: int
) -> dict[str, Any]:
    """Time whole decisions at stops of a tour.

    A decision is a full panorama: twelve frames integrated, frontiers, memory, the offline
    reasoner, weights, waypoint and path. Detection, a model and rendering do not count.

    Args:
        config: Of the navigator.
        small_m2: Area of the small building.
        large_m2: Area of the large one, all of it mapped before the decisions that count.
        size: Width and height of the images.
        timed: How many decisions, the last ones of each tour, count.

    Returns:
        `decide_ms`, the median in the small building; `decide_large_ms`; `decide_growth`, their
        ratio; the areas; `cores` (of the machine).
    """
    small = _decisions(config, Tour(small_m2, *size), timed)
    large = _decisions(config, Tour(large_m2, *size), timed)
    return {
        "decide_ms": 1e3 * small,
        "decide_large_ms": 1e3 * large,
        "decide_growth": large / small,
        "small_m2": small_m2,
        "large_m2": large_m2,
        "size": list(size),
        "cores": os.cpu_count(),
    }


def _decisions(config: NavigatorConfig, tour: Tour, timed: int) -> float:
    """Median seconds of the last decisions of a tour."""
    detector, count = _KnownDetections(), _Count()
    navigator = Navigator(detector, PriorReasoner(), config, count)
    seconds = []
    for stop in range(tour.stops):
        frames = tour.panorama(stop)
        if stop:
            navigator.recall(navigator.knowledge)
        navigator.reset(DECISION_TARGET)
        seconds.append(_decide(navigator, detector, count, frames))
    return float(np.median(seconds[max(WARM_UP_STOPS, tour.stops - timed) :]))


def _decide(
    navigator: Navigator, detector: _KnownDetections, count: _Count, frames: Sequence[TourFrame]
) -> float:
    """Seconds from the first frame of a panorama to the decision that ends it."""
    before = count.decisions
    spent = 0.0
    for frame in frames:
        detector.next = frame.detections
        started = time.perf_counter()
        navigator.act(frame.observation)
        spent += time.perf_counter() - started
    if count.decisions != before + 1:
        raise AssertionError(f"{count.decisions - before} decisions at a stop, not one")
    return spent
