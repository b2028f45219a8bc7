"""p_target = argmax of A over M_nav (Section III-E)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.policy.affordances import Affordances


def select_waypoint(
    affordances: Affordances, admissible: NDArray[np.bool_]
) -> NDArray[np.float64] | None:
    """The admissible point of highest affordance.

    The paper's argmax ranges over all of M_nav; a point that cannot be walked to over known free
    space, or that was tried in vain, is of no use, so the caller rules it out.

    Args:
        affordances: Terms on M_nav.
        admissible: (N,) bool: which points may be chosen.

    Returns:
        (3,) p_target, ties going to the point seen first; None when no point is both safe and
        admissible.
    """
    candidates = affordances.safe & admissible
    if not candidates.any():
        return None
    best = int(np.argmax(np.where(candidates, affordances.total, -np.inf)))
    return np.asarray(affordances.points[best], dtype=np.float64)
