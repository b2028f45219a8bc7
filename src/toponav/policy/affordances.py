"""The affordances of Section III-E on M_nav: six terms, two phases and the safety mask.

For a point p_i of M_nav and a cloud S the paper defines d_i^S, the distance to the nearest point of
S, and N(d_i^S) = 1 - (d_i - d_min) / (d_max - d_min + epsilon). What a term becomes when its S is
empty, which the paper leaves open:

=========  ==========================================  ===========================
term       S                                           empty S
=========  ==========================================  ===========================
A_dir      floor points seen in the chosen view        0 everywhere
A_node     frontier points of the chosen node          0 everywhere
A_front    M_fro                                       0 everywhere
A_hist     trajectory; the term is 1 - N               0 everywhere
A_sem      M_obj of the target                         0 everywhere
A_obs      M_obs                                       0 everywhere: all points safe
=========  ==========================================  ===========================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel
from toponav.mapping.view import MapView

FloatArray = NDArray[np.float64]
Weight = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class Phase(Enum):
    """The two phases: acquisition while g_found = 1 and T_target is in O, else exploration."""

    EXPLORATION = "exploration"
    TARGET_ACQUISITION = "target acquisition"


class AffordanceConfig(ConfigModel):
    """Which terms count, and what is safe. All weights are 1 in the paper; 0 ablates a term."""

    weight_dir: Weight = 1.0
    """Weight of A_dir."""

    weight_node: Weight = 1.0
    """Weight of A_node."""

    weight_front: Weight = 1.0
    """Weight of A_front."""

    weight_hist: Weight = 1.0
    """Weight of A_hist."""

    weight_sem: Weight = 1.0
    """Weight of A_sem."""

    sigma: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.05
    """Safety threshold: a point is safe when 1 - A_obs exceeds it. The paper gives no value."""

    min_clearance_m: Annotated[float, Field(ge=0.0)] = 0.18
    """A safe point is also this far from M_obs on the floor, metres: the agent's radius (PROTOCOL).
    What sigma means in metres depends on the map's size; this does not. 0 leaves sigma alone."""

    epsilon: Annotated[float, Field(gt=0.0)] = 1e-6
    """Keeps N(d) finite when all distances are equal, metres."""


@dataclass(frozen=True, eq=False)
class Affordances:
    """Every term on the points of M_nav.

    Attributes:
        points: (N, 3) float32, M_nav.
        terms: The phase's terms by name ("dir", "node", "front", "hist" or "dir", "sem"), (N,)
            each in [0, 1], unweighted.
        safe: (N,) bool, the indicator I(.).
        total: (N,) weighted sum, 0 where not safe.
    """

    points: NDArray[np.float32]
    terms: Mapping[str, FloatArray]
    safe: NDArray[np.bool_]
    total: FloatArray


def normalized_affordance(
    points: NDArray[np.floating], targets: NDArray[np.floating], epsilon: float
) -> FloatArray:
    """N(d_i^S) of every point: 1 at the point nearest to S, 0 at the farthest.

    Args:
        points: (N, 3) metres.
        targets: (M, 3) metres, the cloud S.
        epsilon: Added to the range of distances, metres.

    Returns:
        (N,) in [0, 1]; zeros when S or the points are empty.
    """
    if not len(points) or not len(targets):
        return np.zeros(len(points))
    # Of few queries: a tree that is sooner built.
    distance, _ = cKDTree(targets, compact_nodes=False, balanced_tree=False).query(points)
    nearest, farthest = distance.min(), distance.max()
    normalized: FloatArray = 1.0 - (distance - nearest) / (farthest - nearest + epsilon)
    return normalized


def exploration(
    view: MapView,
    direction_points: NDArray[np.floating],
    node_frontiers: NDArray[np.floating],
    history: NDArray[np.floating],
    config: AffordanceConfig,
) -> Affordances:
    """A = A_dir + A_node + A_front + A_hist, masked.

    Args:
        view: The map.
        direction_points: S_dir, (N, 3).
        node_frontiers: S_node, (N, 3).
        history: S_hist, (N, 3), trajectory points at floor height.
        config: Weights and threshold.
    """
    points, epsilon = view.navigable.points, config.epsilon
    visited = normalized_affordance(points, history, epsilon)
    terms = {
        "dir": normalized_affordance(points, direction_points, epsilon),
        "node": normalized_affordance(points, node_frontiers, epsilon),
        "front": normalized_affordance(points, view.frontiers, epsilon),
        "hist": 1.0 - visited if len(history) else visited,
    }
    weights = {
        "dir": config.weight_dir,
        "node": config.weight_node,
        "front": config.weight_front,
        "hist": config.weight_hist,
    }
    return _combine(view, terms, weights, config)


def acquisition(
    view: MapView,
    direction_points: NDArray[np.floating],
    target_points: NDArray[np.floating],
    config: AffordanceConfig,
) -> Affordances:
    """A = A_dir + A_sem, masked.

    Args:
        view: The map.
        direction_points: S_dir, (N, 3).
        target_points: S_sem, (N, 3): M_obj of the target.
        config: Weights and threshold.
    """
    points, epsilon = view.navigable.points, config.epsilon
    terms = {
        "dir": normalized_affordance(points, direction_points, epsilon),
        "sem": normalized_affordance(points, target_points, epsilon),
    }
    return _combine(view, terms, {"dir": config.weight_dir, "sem": config.weight_sem}, config)


def _combine(
    view: MapView,
    terms: dict[str, FloatArray],
    weights: dict[str, float],
    config: AffordanceConfig,
) -> Affordances:
    """Sum the weighted terms and zero them near obstacles."""
    points = view.navigable.points
    total = np.zeros(len(points))
    for name, term in terms.items():
        total += weights[name] * term
    safe = _is_safe(points, view.obstacles.points, config)
    return Affordances(points, terms, safe, np.where(safe, total, 0.0))


def _is_safe(
    points: NDArray[np.float32], obstacles: NDArray[np.float32], config: AffordanceConfig
) -> NDArray[np.bool_]:
    """The indicator I(.) of every point."""
    if not len(points) or not len(obstacles):
        return np.ones(len(points), dtype=np.bool_)
    # The paper writes I(A_obs > sigma), but A_obs = N(d) is 1 at the point nearest to an obstacle,
    # so read literally the mask would keep the dangerous points. Its text asks for the opposite
    # ("zeroing out affordances near obstacles"), hence the complement here.
    a_obs = normalized_affordance(points, obstacles, config.epsilon)
    # Infinite where nothing is nearer than that: all that has to be known, and sooner found.
    tree = cKDTree(obstacles[:, :2], compact_nodes=False, balanced_tree=False)
    clearance, _ = tree.query(points[:, :2], distance_upper_bound=config.min_clearance_m)
    return np.asarray((1.0 - a_obs > config.sigma) & (clearance >= config.min_clearance_m))
