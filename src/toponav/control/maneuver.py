"""Through a gap hardly wider than the agent: turns and steps that just fit.

On the grid such a gap is a cell or two wide, and headings come in turns of 30 degrees, so who looks
a few steps straight ahead touches its sides again and again. Here the agent's disc is moved among
the points of the obstacles themselves, step after step in every direction that turns lead to: the
ends of a few steps lie close enough together that some of them meet the gap's middle.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from toponav.control.discrete import FollowerConfig
from toponav.control.planner import Clearance, CostField
from toponav.geometry import Pose
from toponav.mapping.view import FREE, MapView
from toponav.types import Action

EASY_M = 0.04
"""More room than this on either side is as good as any, metres."""

TIGHT_COST_M = 0.4
"""A step without any room costs so much more than one with enough, metres."""

SLACK_M = 0.005
"""Between the points of a surface, and between places along a step, is a little less room."""

SAME_M = 0.02
"""Places nearer to each other than this are one."""

SAMPLES = 6
"""Places along a step at which the agent must fit."""

STAIRS, STEP_M, BODY_M = "stairs", 0.25, 1.0
"""Parts of a flight this far above the agent's foot, metres, are no treads to step on."""

MAX_EXPANDED = 4000
"""Places from which steps are tried before it is given up."""


def solid_points(view: MapView, clearance: Clearance, foot_z: float) -> NDArray[np.float64]:
    """(N, 2) points of what the agent may touch: M_obs, and the sides and rails of flights.

    Args:
        view: The map.
        clearance: Says which cells count as obstacles.
        foot_z: Height of the agent's foot point, metres.
    """
    parts = [view.obstacles.points]
    if STAIRS in view.objects:
        stairs = view.objects[STAIRS].points
        above = stairs[:, 2] - foot_z
        parts.append(stairs[(above > STEP_M) & (above < BODY_M)])
    points = np.concatenate(parts)[:, :2].astype(np.float64)
    cells = view.grid.index_of(points)
    inside = view.grid.contains(cells)
    points, (i, j) = points[inside], cells[inside].T
    in_the_way: NDArray[np.float64] = points[clearance.distance_m[i, j] < 0.0]
    return in_the_way


@dataclass(frozen=True, eq=False)
class _Place:
    """Where some steps lead: a node of the search.

    Attributes:
        xy: (2,) metres.
        heading: Of the step that led there, in turns to the left of the agent's heading now.
        cost: Of the way there, metres.
        room_m: Distance of the nearest obstacle.
        before: Where the last step began; None where the agent stands.
    """

    xy: NDArray[np.float64]
    heading: int
    cost: float
    room_m: float
    before: _Place | None

    @property
    def key(self) -> tuple[int, int]:
        x, y = self.xy.tolist()
        return round(x / SAME_M), round(y / SAME_M)


def maneuver(
    world_from_base: Pose,
    field: CostField,
    obstacles: NDArray[np.floating],
    motion: FollowerConfig,
    radius_m: float,
    gain_m: float,
) -> tuple[Action, ...]:
    """Turns and forward steps to a place from which the way is shorter; empty if none is found.

    Args:
        world_from_base: Where the agent stands.
        field: Cost-to-go, also through what seems too narrow on the grid.
        obstacles: (N, 2 or 3) points of what is in the way, metres.
        motion: The agent's steps and turns.
        radius_m: Of the agent.
        gain_m: By how much the way must become shorter, metres.
    """
    here = world_from_base.translation[:2].astype(np.float64)
    way = float(field.at(here))
    reach = 2.0 * gain_m + 1.0
    near = obstacles[np.hypot(*(obstacles[:, :2] - here).T) <= reach, :2]
    if not math.isfinite(way) or not len(near):
        return ()
    search = _Search(world_from_base.yaw, field, cKDTree(near), motion, radius_m)
    return search.run(here, max(way - gain_m, 0.5 * motion.forward_m))


class _Search:
    """A* over the ends of forward steps; ties go to the place found first."""

    def __init__(
        self,
        yaw: float,
        field: CostField,
        obstacles: cKDTree,
        motion: FollowerConfig,
        radius_m: float,
    ) -> None:
        self._field = field
        self._obstacles = obstacles
        self._motion = motion
        self._radius_m = radius_m + SLACK_M
        self._full_turn = round(360.0 / motion.turn_deg)
        headings = yaw + np.arange(self._full_turn) * math.radians(motion.turn_deg)
        direction = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
        along = np.linspace(0.0, motion.forward_m, SAMPLES + 1)[1:]
        self._strides = direction[:, None, :] * along[:, None]

    def run(self, here: NDArray[np.float64], enough: float) -> tuple[Action, ...]:
        """To the first place from which the way costs no more than `enough`."""
        first = _Place(here, 0, 0.0, float(self._obstacles.query(here)[0]), None)
        best, found = {first.key: first}, 0
        queue = [(0.0, found, first)]
        for _ in range(MAX_EXPANDED):
            if not queue:
                break
            _, _, place = heapq.heappop(queue)
            if best[place.key] is not place:
                continue
            if float(self._field.at(place.xy)) <= enough:
                return self._actions(place)
            for onward, way in self._steps(place):
                known = best.get(onward.key)
                if known is None or onward.cost < known.cost:
                    best[onward.key] = onward
                    found += 1
                    heapq.heappush(queue, (onward.cost + max(0.0, way - enough), found, onward))
        return ()

    def _steps(self, place: _Place) -> list[tuple[_Place, float]]:
        """The ends of the steps that fit, and the cost of the way from there."""
        samples = place.xy + self._strides
        rooms = self._obstacles.query(samples)[0]
        room = rooms.min(axis=1)
        grid = self._field.clearance.grid
        cells = grid.index_of(samples)
        inside = grid.contains(cells)
        i, j = np.moveaxis(np.where(inside[..., None], cells, 0), -1, 0)
        free = (inside & (grid.cells[i, j] == FREE)).all(axis=1)
        ends = samples[:, -1]
        ways = self._field.at(ends)
        # Who touches something may leave it.
        fits = free & (room >= min(self._radius_m, place.room_m)) & np.isfinite(ways)
        tight = np.clip(1.0 - (room - self._radius_m) / EASY_M, 0.0, 1.0)
        motion = self._motion
        steps = []
        for heading in np.flatnonzero(fits).tolist():
            turns = abs(self._turns(place.heading, heading))
            cost = motion.forward_m + motion.turn_cost_m * turns + TIGHT_COST_M * tight[heading]
            onward = _Place(
                ends[heading],
                heading,
                place.cost + float(cost),
                float(rooms[heading, -1]),
                place,
            )
            steps.append((onward, float(ways[heading])))
        return steps

    def _turns(self, heading: int, onto: int) -> int:
        """Turns to the left from one heading onto another; to the right where negative."""
        half = self._full_turn // 2
        return (onto - heading + half) % self._full_turn - half

    def _actions(self, place: _Place) -> tuple[Action, ...]:
        """What leads there."""
        backwards = []
        while place.before is not None:
            turns = self._turns(place.before.heading, place.heading)
            turn = Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT
            backwards += [Action.MOVE_FORWARD, *[turn] * abs(turns)]
            place = place.before
        return tuple(reversed(backwards))
