"""Which frontier next: by where the target may be, how much is unseen there, and the way there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.control.expected_arrival import MAX_PLACES, soonest_order
from toponav.control.frontier_clusters import FrontierCluster
from toponav.control.looks import Looks
from toponav.control.planner import CostField, Planner
from toponav.mapping.unknown_area import unknown_area_m2
from toponav.mapping.view import MapView
from toponav.policy.decision import WeighedFrontier
from toponav.policy.glimpses import Glimpse

Positive = Annotated[float, Field(gt=0.0)]
TREAD_M = 0.15
"""A stair this far above or below the floor leads to another."""

LANDING_M = 0.5
"""The next floor is no nearer than two treads."""

STOREY_M = (-0.3, 2.5)
"""Heights over the floor between which things are on this storey."""

GLIMPSED = "the target"
"""Speaks for a frontier that leads to where the target was seen."""

FAR_LOOK = 3.0
"""A look from more than so many times `looked_m` takes nothing from what a frontier promises."""

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

    unknown_reach_m: Positive = 4.0
    """How far beyond a frontier unknown floor counts."""

    unknown_half_m2: Positive = 12.0
    """Unknown floor that makes 63 % of a fully open frontier."""

    guided_node: Annotated[float, Field(ge=1.0)] = 1.5
    """Factor on frontiers about the place that the reasoner names."""

    glimpse: Annotated[float, Field(ge=0.0)] = 4.0
    """What a glimpse of the target with score 1 adds to the frontier that leads to it."""

    other_floor: Annotated[float, Field(ge=0.0)] = 1.5
    """Promise of stairs to a floor that was not seen yet: as that of some four frontiers."""

    edge_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.15
    """Share of that for an edge from which stairs may be seen that lead down: a look from there
    costs no more than the way to it."""

    storey_m: Annotated[float, Field(ge=0.0)] = 15.0
    """What stairs cost beyond the way to them, metres: the flight, and some of the search of the
    floor to which they lead, before something is found there."""

    places: Annotated[int, Field(ge=1, le=MAX_PLACES)] = 10
    """Frontiers whose order is worked out; of more, those that promise most for their distance."""

    between: Positive = 30.0
    """Ways between frontiers that cost more are taken to lead by where the agent is."""

    vanished_m: Positive = 0.5
    """A frontier is gone when no frontier cell is left this near to its waypoint."""

    looked_m: Positive = 1.5
    """A frontier that was in view from this near, and is still there, promises half of one that was
    seen from afar: what can be seen of it has been."""

    revisit_m: Positive = 2.5
    """Where nothing is left to explore, places of an earlier search that were not in view from this
    near are gone to."""

    rest_m: Positive = 1.0
    """On arrival, frontier cells this near are looked at first."""


@dataclass(frozen=True, eq=False)
class Belief:
    """What speaks for the target being about.

    Attributes:
        affinity: By category, how likely the target is beside such an object, in [0, 1].
        guided: (M, 2) frontier cells about the place that the reasoner names.
        glimpses: Where it was seen, too far off to be mapped.
        elsewhere: Whether it was seen on another storey.
        looks: Where the camera has looked.
    """

    affinity: Mapping[str, float]
    guided: NDArray[np.float64]
    glimpses: tuple[Glimpse, ...] = ()
    elsewhere: bool = False
    looks: Looks = field(default_factory=Looks)


def ranked_frontiers(
    places: tuple[Sequence[FrontierCluster], Sequence[WeighedFrontier]],
    belief: Belief,
    view: MapView,
    reach: CostField,
    planner: Planner,
    config: SearchPlanConfig,
) -> tuple[WeighedFrontier, ...]:
    """The frontiers in the order that finds the target soonest; those not ordered come last.

    Args:
        places: The frontiers of this floor, and what leads to others (`off_this_floor`); one or
            more in all.
        belief: Where the target may be.
        view: The map.
        reach: Cost of walking from the agent to every cell.
        planner: Finds the ways between frontiers.
        config: Weights.
    """
    frontiers, stairs = places
    objects = _objects_near(frontiers, belief, view, config)
    middles = np.array([frontier.middle for frontier in frontiers]).reshape(-1, 2)
    looked_m = belief.looks.nearest_m(middles, view, FAR_LOOK * config.looked_m)
    is_guided = np.zeros(view.grid.cells.shape, np.bool_)
    is_guided[tuple(_cells_of(belief.guided, view).T)] = True
    weighed = [
        _weigh(frontier, (near, looked), is_guided, belief, view, config)
        for frontier, near, looked in zip(frontiers, objects, looked_m.tolist(), strict=True)
    ]
    for glimpse in belief.glimpses if frontiers else ():
        k = _leading_to(glimpse.place[None], frontiers)
        promise = weighed[k].promise + config.glimpse * glimpse.score
        weighed[k] = replace(weighed[k], promise=promise, speaks=GLIMPSED)
    weighed += stairs
    chance = np.array([frontier.promise for frontier in weighed])
    beyond = np.array([config.storey_m if frontier.on_stairs else 0.0 for frontier in weighed])
    cost = np.array([frontier.path_cost for frontier in weighed]) + beyond
    by_promise = np.argsort(-chance / (cost + 1.0), kind="stable")
    kept, rest = by_promise[: config.places], by_promise[config.places :]
    stands = np.stack([weighed[k].waypoint for k in kept])
    extra = beyond[kept, None] + beyond[kept]
    by_the_agent = cost[kept, None] + cost[kept]
    within = np.minimum(by_the_agent - extra, config.between)
    between = planner.costs_between(reach, stands, within) + extra
    between = np.minimum(between, by_the_agent)
    between[~np.isfinite(between)] = UNREACHABLE_M
    order = soonest_order(cost[kept], between, chance[kept])
    ranked = [replace(weighed[kept[place]], rank=rank) for rank, place in enumerate(order)]
    return (*ranked, *(weighed[k] for k in rest))


def landing(view: MapView, reach: CostField) -> NDArray[np.float64] | None:
    """The (3,) nearest place off the stairs, or the tread nearest to the floor's height.

    It is at least `LANDING_M` away: the agent stands on a tread, whatever the map knows of it. None
    where it can walk nowhere.
    """
    cells = np.argwhere(np.isfinite(reach.cost) & (reach.cost >= LANDING_M))
    if not len(cells):
        return None
    i, j = cells.T
    stairs = np.full(len(cells), np.nan) if view.grid.stairs is None else view.grid.stairs[i, j]
    off_floor = np.where(np.abs(stairs) >= TREAD_M, np.abs(stairs), 0.0)  # NaN is no stair
    first = np.lexsort((reach.cost[i, j], off_floor))[0]
    return np.array([*view.grid.center_of(cells[first]), view.floor_z])


def frontier_towards(
    clusters: Sequence[FrontierCluster], target_points: NDArray[np.floating]
) -> NDArray[np.float64]:
    """The (3,) waypoint of the frontier by which a target that is seen may be reached.

    The way to it over known floor, and from there straight to the target, is the shortest.

    Args:
        clusters: One or more.
        target_points: (N, 3) the target, N >= 1, world frame, metres.
    """
    return clusters[_leading_to(target_points, clusters)].nearest


def _leading_to(points: NDArray[np.floating], clusters: Sequence[FrontierCluster]) -> int:
    """The frontier on the shortest way to some points, straight on from its waypoint."""

    def way(k: int) -> float:
        rest = points[:, :2] - clusters[k].nearest[:2]
        return clusters[k].path_cost + float(np.hypot(rest[:, 0], rest[:, 1]).min())

    return min(range(len(clusters)), key=way)


def _objects_near(
    clusters: Sequence[FrontierCluster], belief: Belief, view: MapView, config: SearchPlanConfig
) -> list[dict[str, float]]:
    """For each frontier: how far off those categories are that are near it on this storey."""
    waypoints = np.array([cluster.nearest[:2] for cluster in clusters]).reshape(-1, 2)
    storey = (view.floor_z + STOREY_M[0], view.floor_z + STOREY_M[1])
    found = view.objects_near(waypoints, config.seen_radius_m, storey)
    told = belief.affinity
    return [{name: near[name].distance_m for name in told if name in near} for near in found]


def _weigh(
    cluster: FrontierCluster,
    known: tuple[Mapping[str, float], float],
    is_guided: NDArray[np.bool_],
    belief: Belief,
    view: MapView,
    config: SearchPlanConfig,
) -> WeighedFrontier:
    """What a frontier of this floor promises, and why.

    Known are how far off things are, and from how near it was looked at, metres.
    """
    objects, looked_m = known
    cells = _cells_of(cluster.cells, view)
    area = unknown_area_m2(view.grid, cells, config.unknown_reach_m)
    unseen = 1.0 - math.exp(-area / config.unknown_half_m2)
    likelihood, speaks = config.base_likelihood, ""
    for category, distance in objects.items():
        nearness = 1.0 / (1.0 + (distance / config.seen_half_m) ** 2)
        if belief.affinity[category] * nearness > likelihood:
            likelihood, speaks = belief.affinity[category] * nearness, category
    unseen *= 1.0 - math.exp2(-((looked_m / config.looked_m) ** 2))
    guided = bool(is_guided[tuple(cells.T)].any())
    weight = config.guided_node if guided else 1.0
    return WeighedFrontier(
        waypoint=cluster.nearest,
        cells=cluster.size,
        path_cost=cluster.path_cost,
        unknown_m2=area,
        likelihood=likelihood,
        speaks=speaks,
        guided=guided,
        on_stairs=False,
        promise=weight * unseen * math.pow(likelihood, config.semantic_exponent),
    )


def off_this_floor(
    place: FrontierCluster, promise: float, speaks: str, *, on_stairs: bool
) -> WeighedFrontier:
    """Stairs to another floor, or an edge from which they may be seen.

    Args:
        place: Where.
        promise: What the other floor promises.
        speaks: What speaks for it; empty for nothing.
        on_stairs: Whether it is on stairs.
    """
    return WeighedFrontier(
        waypoint=place.nearest,
        cells=place.size,
        path_cost=place.path_cost,
        unknown_m2=0.0,
        likelihood=0.0,
        speaks=speaks,
        guided=False,
        on_stairs=on_stairs,
        promise=promise,
    )


def is_on_stairs(cluster: FrontierCluster, view: MapView) -> bool:
    """Whether a frontier's waypoint is a tread."""
    if view.grid.stairs is None:
        return False
    i, j = view.grid.index_of(cluster.nearest)
    return bool(np.abs(view.grid.stairs[i, j]) >= TREAD_M)  # NaN, no stair, is not


def _cells_of(points: NDArray[np.float64], view: MapView) -> NDArray[np.int64]:
    """(N, 2) cells of the grid nearest to (N, 2 or 3) points."""
    last = np.array(view.grid.cells.shape) - 1
    cells: NDArray[np.int64] = np.clip(view.grid.index_of(points), 0, last)
    return cells
