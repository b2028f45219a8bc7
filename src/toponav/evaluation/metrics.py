"""ObjectNav metrics, to the digit of habitat-lab's definitions (docs/protocol.md)."""

from __future__ import annotations

import math
from collections.abc import Sequence

SUCCESS_RADII_M = (0.1, 0.2, 0.25, 1.0)
"""Radii at which peers report success; 0.1 m is the benchmark's own."""

BENCHMARK_RADIUS_M = 0.1


def success(stop_called: bool, distance_to_goal: float, radius_m: float) -> bool:
    """Whether the agent stopped strictly within `radius_m` of a viewpoint of the goal."""
    return stop_called and distance_to_goal < radius_m


def spl(succeeded: bool, shortest_path: float, path_length: float) -> float:
    """Success weighted by path length: S l / max(l, p).

    An episode that starts at its goal (l = 0) and does not move has made the best path there is,
    so it counts 1; l = infinity (no path existed) counts 0.
    """
    return _path_efficiency(shortest_path, path_length) if succeeded else 0.0


def soft_spl(distance_to_goal: float, shortest_path: float, path_length: float) -> float:
    """Progress weighted by path length: max(0, 1 - DTG / l) l / max(l, p).

    With l = 0 the progress is 1 when the agent is still at a goal and 0 otherwise.
    """
    if not math.isfinite(distance_to_goal) or not math.isfinite(shortest_path):
        return 0.0
    if shortest_path > 0.0:
        progress = max(0.0, 1.0 - distance_to_goal / shortest_path)
    else:
        progress = 1.0 if distance_to_goal == 0.0 else 0.0
    return progress * _path_efficiency(shortest_path, path_length)


def _path_efficiency(shortest_path: float, path_length: float) -> float:
    if not math.isfinite(shortest_path):
        return 0.0
    longest = max(shortest_path, path_length)
    return shortest_path / longest if longest > 0.0 else 1.0


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """Wilson score interval of a rate, 95 % by default; (0, 1) without trials."""
    if trials == 0:
        return 0.0, 1.0
    rate = successes / trials
    denominator = 1.0 + z * z / trials
    center = (rate + z * z / (2 * trials)) / denominator
    half = z * math.sqrt(rate * (1 - rate) / trials + z * z / (4 * trials * trials)) / denominator
    return max(0.0, center - half), min(1.0, center + half)


def finite_mean(values: Sequence[float]) -> tuple[float | None, int]:
    """Mean of the finite values (None without any) and how many were infinite.

    An episode without a path to any viewpoint has an infinite distance: it is counted, by name,
    and kept out of the mean.
    """
    finite = [value for value in values if math.isfinite(value)]
    mean = math.fsum(finite) / len(finite) if finite else None
    return mean, len(values) - len(finite)
