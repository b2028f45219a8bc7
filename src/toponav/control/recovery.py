"""What to do when the world disagrees with the map: bumps, no progress, waypoints in vain."""

from __future__ import annotations

import math
from collections import Counter, deque

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field
from scipy.spatial import cKDTree

from toponav.config_model import ConfigModel
from toponav.control.discrete import HeadingBarred
from toponav.control.planner import CostField
from toponav.geometry import Pose
from toponav.mapping.view import OCCUPIED, OccupancyGrid


class RecoveryConfig(ConfigModel):
    """When a heading, a cell or a waypoint is given up."""

    bump_radius_m: float = Field(default=0.2, ge=0.0)
    """A heading that was blocked is barred within this distance of the bump, metres."""

    bump_angle_deg: float = Field(default=20.0, ge=0.0)
    """Headings this close to a blocked one are barred with it, degrees: less than a turn."""

    touching_m: float = Field(default=0.05, ge=0.0)
    """This near to an unexplained bump, metres, the agent still touches what it felt ..."""

    wall_angle_deg: float = Field(default=85.0, ge=0.0, le=90.0)
    """... and headings this close to the blocked one are barred, degrees: all that lead into a wall
    across it."""

    contact_m: float = Field(default=0.25, gt=0.0)
    """How far ahead of the agent's centre it touches what blocks it, metres: its 0.18 m radius and
    most of a 0.1 m cell."""

    explained_m: float = Field(default=0.35, ge=0.0)
    """A mapped obstacle this near on the side of the bump explains it, metres."""

    bumps_to_block: int = Field(default=3, ge=1)
    """Bumps within `bump_radius_m` of each other after which explained ones block, too."""

    given_up_m: float = Field(default=0.6, ge=0.0)
    """Where a walk is given up, explained bumps within this distance, metres, block from then on,
    until one is given up there again: the gap is wide enough on the map, but not for steps and
    turns of the agent's size."""

    maneuver_m: float = Field(default=0.0, ge=0.0)
    """After a second bump in one place, turns and steps that just fit are sought until the way is
    shorter by this, metres; 0 seeks none."""

    body_m: float = Field(default=0.15, ge=0.0)
    """Within this distance of where the agent has stood there is no obstacle that no image shows,
    metres: a little less than its radius."""

    window_steps: int = Field(default=30, ge=1)
    """Steps over which progress is looked for; a half turn takes six."""

    min_progress_m: float = Field(default=0.2, gt=0.0)
    """A walk that gets no nearer than this within the window is given up: most of a step."""

    barren_radius_m: float = Field(default=0.5, ge=0.0)
    """Waypoints this near to one that was given up are ruled out ..."""

    barren_decisions: int = Field(default=8, ge=0)
    """... for this many decisions."""


SAME_M, SAME_RAD, VISITS = 0.05, 0.1, 3
"""Poses that are as near as this, metres and radians, are the same; so many visits are a circle."""

STOOD_APART_M = 0.1
"""Of places nearer to each other than this, metres, one is remembered."""


BACK_M, BACK_RAD = (0.15, 0.3), 0.15
"""A place so far off, metres, is a step back; that near to its bearing, radians, one goes there."""


class BumpMemory:
    """Remembers where forward steps were cut short.

    A bump beside a mapped obstacle is a graze and only bars its heading, until a walk is given up
    there. One that nothing on the map explains means an obstacle that no image shows: it is put on
    the map where it was felt, and forgotten once the map shows something there, or the agent
    passes, or walks are given up there again. What it came through it can go back through: it only
    has to aim better.
    """

    def __init__(self, config: RecoveryConfig) -> None:
        """Start without bumps."""
        self._config = config
        self._bumps = np.zeros((0, 3))
        self._forced = np.zeros(0, np.bool_)
        self._stood: dict[tuple[int, int], tuple[float, float]] = {}
        self._given_up: list[NDArray[np.float64]] = []

    def stand(self, xy: ArrayLike) -> None:
        """The agent stands at (2 or 3,) a place."""
        x, y = (float(v) for v in np.asarray(xy, dtype=np.float64)[:2])
        self._stood[round(x / STOOD_APART_M), round(y / STOOD_APART_M)] = (x, y)

    def add(self, world_from_base: Pose) -> None:
        """A forward step ended here, blocked."""
        bump = (*world_from_base.translation[:2], world_from_base.yaw)
        self._bumps = np.vstack([self._bumps, bump])
        self._forced = np.append(self._forced, False)

    def give_up(self, xy: ArrayLike) -> None:
        """A walk got no farther than (2,) xy: do not lead the next one through the same gap.

        Where that happens again, what was learnt by bumping has led nowhere: it is forgotten.
        """
        near = self._away(xy) <= self._config.given_up_m
        here = np.asarray(xy, dtype=np.float64)
        reach_m = self._config.given_up_m
        elsewhere = [place for place in self._given_up if math.dist(here, place) > reach_m]
        if len(elsewhere) == len(self._given_up):
            self._given_up.append(here)
            self._forced |= near
        else:
            self._given_up = elsewhere
            self._bumps, self._forced = self._bumps[~near], self._forced[~near]

    def is_gap(self, xy: ArrayLike, grid: OccupancyGrid) -> bool:
        """Whether the agent has grazed what is mapped about (2,) xy more than once.

        Not where a walk was given up already, or where something is that no image shows.
        """
        about = self._away(xy) <= self._config.given_up_m
        grazes = self._explained(grid) & ~self._forced
        return bool(about.sum() > 1 and grazes[about].all())

    def barring(self, xy: ArrayLike, grid: OccupancyGrid, *, back: bool = False) -> HeadingBarred:
        """Tells the headings at which a forward step from (2,) xy would be blocked again.

        Args:
            xy: Where the agent stands, world frame, metres.
            grid: Known space.
            back: Where it came from it can go back, whatever it has bumped into beside that way.
        """
        config = self._config
        distance = self._away(xy)
        touching = ~self._explained(grid) & (distance <= config.touching_m)
        limit = np.radians(np.where(touching, config.wall_angle_deg, config.bump_angle_deg))
        near = distance <= config.bump_radius_m
        ways_back = self._ways_back(xy) if back else np.zeros(0)

        def barred(heading: float) -> bool:
            turn = np.abs(_turns(self._bumps[:, 2], heading))
            if (np.abs(_turns(ways_back, heading)) <= BACK_RAD).any():
                return bool((near & (turn <= SAME_RAD)).any())
            return bool((near & (turn <= limit)).any())

        return barred

    def obstacles(self, grid: OccupancyGrid) -> NDArray[np.float64]:
        """(N, 2) positions that count as obstacles though the map shows none, metres."""
        xy = self._bumps[:, :2]
        apart = np.linalg.norm(xy[:, None] - xy[None], axis=-1)
        repeated = (apart <= self._config.bump_radius_m).sum(axis=1) >= self._config.bumps_to_block
        felt = repeated | self._forced | ~self._explained(grid)
        contact: NDArray[np.float64] = (xy + self._config.contact_m * self._ahead)[felt]
        if not len(contact) or not self._stood:
            return contact
        stood = np.array(list(self._stood.values()))
        away, _ = cKDTree(stood).query(contact)
        unvisited: NDArray[np.float64] = contact[away > self._config.body_m]
        return unvisited

    def _ways_back(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(K,) headings from (2,) xy to where the agent has stood, about a step away, radians."""
        offset = np.array(list(self._stood.values())).reshape(-1, 2) - np.asarray(xy, np.float64)
        away = np.hypot(offset[:, 0], offset[:, 1])
        offset = offset[(away >= BACK_M[0]) & (away <= BACK_M[1])]
        headings: NDArray[np.float64] = np.arctan2(offset[:, 1], offset[:, 0])
        return headings

    def _away(self, xy: ArrayLike) -> NDArray[np.float64]:
        """(N,) distance of the bumps from (2,) xy, metres."""
        offset = self._bumps[:, :2] - np.asarray(xy, dtype=np.float64)
        away: NDArray[np.float64] = np.linalg.norm(offset, axis=1)
        return away

    @property
    def _ahead(self) -> NDArray[np.float64]:
        """(N, 2) unit vectors of the blocked headings."""
        return np.stack([np.cos(self._bumps[:, 2]), np.sin(self._bumps[:, 2])], axis=-1)

    def _explained(self, grid: OccupancyGrid) -> NDArray[np.bool_]:
        """(N,) bool: bumps with a mapped obstacle close by in the half plane ahead."""
        reach = math.ceil(self._config.explained_m / grid.resolution)
        side = np.arange(-reach, reach + 1)
        window = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
        xy = self._bumps[:, None, :2]
        cells = grid.index_of(xy) + window
        inside = grid.contains(cells)
        i, j = np.moveaxis(np.where(inside[..., None], cells, 0), -1, 0)
        offset = grid.center_of(cells) - xy
        close = np.linalg.norm(offset, axis=-1) <= self._config.explained_m
        in_front = (offset * self._ahead[:, None]).sum(axis=-1) > 0.0
        explains = inside & close & in_front & (grid.cells[i, j] == OCCUPIED)
        return np.asarray(explains.any(axis=1))


class ProgressMonitor:
    """Notices that a walk gets no nearer to its goal, standing still or going in circles."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start a walk."""
        self._config = config
        self.restart()

    def restart(self) -> None:
        """A new goal: what came before does not count."""
        self._last_xy: NDArray[np.float64] | None = None
        self._visits: Counter[tuple[int, int, int]] = Counter()
        self._last_cell: tuple[int, int] | None = None
        self._gains: deque[float] = deque(maxlen=self._config.window_steps)

    def circles(self, world_from_base: Pose) -> bool:
        """Add a step; whether this walk has come back to the same place and heading time and again.

        Turns and bumps on the spot do not count: by them it feels its way round an obstacle.
        """
        i, j = np.rint(world_from_base.translation[:2] / SAME_M).astype(int).tolist()
        if (i, j) == self._last_cell:
            return False
        self._last_cell = i, j
        pose = i, j, round(world_from_base.yaw / SAME_RAD)
        self._visits[pose] += 1
        return self._visits[pose] >= VISITS

    def stalled(self, xy: ArrayLike, field: CostField) -> bool:
        """Add a step; whether the window's steps together brought the goal too little nearer.

        Each step is judged by the field of the map as it is after it, so a way that turns out to
        be longer than it seemed is no lack of progress.

        Args:
            xy: (2,) where the agent stands, world frame, metres.
            field: Cost-to-go on the map as it is now.
        """
        here = np.array(xy, dtype=np.float64)
        if self._last_xy is not None:
            before, now = field.at(np.stack([self._last_xy, here]))
            self._gains.append(float(before - now) if math.isfinite(before + now) else 0.0)
        self._last_xy = here
        full = len(self._gains) == self._config.window_steps
        return full and sum(self._gains) < self._config.min_progress_m


class BarrenWaypoints:
    """Waypoints that were given up, ruled out for some decisions and then forgiven."""

    def __init__(self, config: RecoveryConfig) -> None:
        """Start without any."""
        self._config = config
        self._until: list[tuple[NDArray[np.float64], int]] = []

    def add(self, waypoint: ArrayLike, decision: int) -> None:
        """Rule out a (2 or 3,) waypoint at the given decision count."""
        expiry = decision + self._config.barren_decisions
        self._until.append((np.asarray(waypoint, dtype=np.float64)[:2], expiry))

    def admissible(self, points: NDArray[np.floating], decision: int) -> NDArray[np.bool_]:
        """(N,) bool: which of (N, 2 or 3) points are not ruled out at this decision."""
        allowed = np.ones(len(points), dtype=np.bool_)
        for waypoint, expiry in self._until:
            if decision <= expiry:
                offset = points[:, :2] - waypoint
                allowed &= np.hypot(offset[:, 0], offset[:, 1]) > self._config.barren_radius_m
        return allowed


def _turns(to: NDArray[np.float64], heading: float) -> NDArray[np.float64]:
    """(N,) turns from a heading to others, radians, in [-pi, pi)."""
    turns: NDArray[np.float64] = np.remainder(to - heading + np.pi, 2.0 * np.pi) - np.pi
    return turns
