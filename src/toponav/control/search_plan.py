"""Which frontier next: by where the target may be, how much is unseen there, and the way there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.control.expected_arrival import MAX_PLACES, soonest_order
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.planner import CostField, Planner
from toponav.mapping.unknown_area import unknown_area_m2
from toponav.mapping.view import MapView
from toponav.policy.decision import WeighedFrontier

Positive = Annotated[float, Field(gt=0.0)]
STAIRS = "stairs"
"""The category of what leads to another floor."""

UNREACHABLE_M = 1e4
"""Stands for a way that the map does not know yet."""


class SearchPlanConfig(ConfigModel):
    """How frontiers are weighed."""

    semantic_exponent: Annotated[float, Field(ge=0.0)] = 0.5
    """Power of the likelihood that the target is near a frontier: below 1, since it is rough."""

    seen_radius_m: Positive = 3.0
    """Objects farther than this from a frontier say nothing of what lies beyond it."""

    seen_half_m: Positive = 2.0
    """Distance that halves what an object says."""

    base_likelihood: Annotated[float, Field(gt=0.0, le=1.0)] = 0.1
    """Likelihood near a frontier with nothing telling about it."""

    unknown_reach_m: Positive = 2.5
    """How far beyond a frontier unknown floor counts."""

    unknown_half_m2: Positive = 4.0
    """Unknown floor that makes 63 % of a fully open frontier."""

    guided_node: Annotated[float, Field(ge=1.0)] = 1.5
    """Factor on frontiers about the place that the reasoner names."""

    stairs_weight: Annotated[float, Field(ge=0.0, le=1.0)] = 0.05
    """Factor on frontiers on stairs: a floor is searched before it is left."""

    stairs_m: Positive = 0.6
    """A frontier this near to stairs is on them."""

    places: Annotated[int, Field(ge=1, le=MAX_PLACES)] = 10
    """Frontiers whose order is worked out; of more, those that promise most for their distance."""

    vanished_m: Positive = 0.5
    """A frontier is gone when no frontier cell is left this near to its waypoint."""

    rest_m: Positive = 1.0
    """On arrival, frontier cells this near are looked at first."""


@dataclass(frozen=True, eq=False)
class Belief:
    """What speaks for the target being about.

    Attributes:
        affinity: By category, how likely the target is beside such an object, in [0, 1].
        guided: (M, 2) frontier cells about the place that the reasoner names.
    """

    affinity: Mapping[str, float]
    guided: NDArray[np.float64]


def ranked_frontiers(
    clusters: Sequence[FrontierCluster],
    belief: Belief,
    view: MapView,
    reach: CostField,
    planner: Planner,
    config: SearchPlanConfig,
) -> tuple[WeighedFrontier, ...]:
    """The frontiers in the order that finds the target soonest; those not ordered come last.

    Args:
        clusters: One or more.
        belief: Where the target may be.
        view: The map.
        reach: Cost of walking from the agent to every cell.
        planner: Finds the ways between frontiers.
        config: Weights.
    """
    weighed = [_weigh(cluster, belief, view, config) for cluster in clusters]
    chance = np.array([frontier.promise for frontier in weighed])
    cost = np.array([frontier.path_cost for frontier in weighed])
    by_promise = np.argsort(-chance / (cost + 1.0), kind="stable")
    kept, rest = by_promise[: config.places], by_promise[config.places :]
    places = np.stack([weighed[k].waypoint for k in kept])
    between = np.stack([planner.cost_field(reach.clearance, p).at(places) for p in places[:, :2]])
    between = np.minimum(between, between.T)
    between[~np.isfinite(between)] = UNREACHABLE_M
    order = soonest_order(cost[kept], between, chance[kept])
    ranked = [replace(weighed[kept[place]], rank=rank) for rank, place in enumerate(order)]
    return (*ranked, *(weighed[k] for k in rest))


def frontier_towards(
    clusters: Sequence[FrontierCluster], target_points: NDArray[np.floating]
) -> NDArray[np.float64]:
    """The (3,) waypoint of the frontier by which a target that is seen may be reached.

    The way to it over known floor, and from there straight to the target, is the shortest.

    Args:
        clusters: One or more.
        target_points: (N, 3) the target, N >= 1, world frame, metres.
    """

    def way(cluster: FrontierCluster) -> float:
        rest = target_points[:, :2] - cluster.nearest[:2]
        return cluster.path_cost + float(np.hypot(rest[:, 0], rest[:, 1]).min())

    return min(clusters, key=way).nearest


def _weigh(
    cluster: FrontierCluster, belief: Belief, view: MapView, config: SearchPlanConfig
) -> WeighedFrontier:
    """What a frontier promises, and why."""
    cells = np.clip(view.grid.index_of(cluster.cells), 0, np.array(view.grid.cells.shape) - 1)
    area = unknown_area_m2(view.grid, cells, config.unknown_reach_m)
    unseen = 1.0 - math.exp(-area / config.unknown_half_m2)
    likelihood, speaks = config.base_likelihood, ""
    for category, affinity in belief.affinity.items():
        distance = _distance_to(category, cluster, view)
        if distance <= config.seen_radius_m:
            nearness = 1.0 / (1.0 + (distance / config.seen_half_m) ** 2)
            if affinity * nearness > likelihood:
                likelihood, speaks = affinity * nearness, category
    guided = _holds_any(cluster, belief.guided)
    weight = config.guided_node if guided else 1.0
    on_stairs = STAIRS in view.objects and _distance_to(STAIRS, cluster, view) <= config.stairs_m
    if on_stairs:
        weight *= config.stairs_weight
    return WeighedFrontier(
        waypoint=cluster.nearest,
        cells=cluster.size,
        path_cost=cluster.path_cost,
        unknown_m2=area,
        likelihood=likelihood,
        speaks=speaks,
        guided=guided,
        on_stairs=on_stairs,
        promise=weight * unseen * math.pow(likelihood, config.semantic_exponent),
    )


def _distance_to(category: str, cluster: FrontierCluster, view: MapView) -> float:
    """From a frontier's waypoint to the nearest point of a category on this storey, metres."""
    points = view.objects[category].points
    height = points[:, 2] - view.floor_z
    on_storey = points[(height > -0.3) & (height < 2.5), :2]
    if not len(on_storey):
        return math.inf
    return float(np.hypot(*(on_storey - cluster.nearest[:2]).T).min())


def _holds_any(cluster: FrontierCluster, points: NDArray[np.float64]) -> bool:
    """Whether a frontier holds one of some frontier cells."""
    if not len(points):
        return False
    own = {(round(float(x), 3), round(float(y), 3)) for x, y in cluster.cells}
    return any((round(float(x), 3), round(float(y), 3)) in own for x, y in points[:, :2])
