"""How fast the robot may drive: slow enough to stop before what its depth images show ahead."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.geometry import Intrinsics, Pose
from toponav.mapping.view import OCCUPIED, OccupancyGrid
from toponav.robot.footprint import Footprint
from toponav.robot.motion import MotionConfig
from toponav.robot.seen_floor import SeenFloor

SAMPLED_COLUMNS = 80
"""Columns of a depth image that are looked at: 1 degree apart, 3 cm at 1.5 m."""

BIN_M = 0.05
"""Side of the squares in which points are counted, metres."""

SEEN_THROUGH_M = 0.15
"""A point is gone where a return lies farther behind it than this, metres."""

AHEAD_S = 0.4
"""A turning robot looks where it will be heading in so long, seconds."""

SWEPT_RAD = (0.1, 0.25, 0.4)
"""Turns ahead over which the floor below the ends must have been seen: 14 cm for a dog's."""

LEAST_SEEN = 0.5
"""Share of the floor ahead that must have been seen; squares at its rim are often not."""

LEAST_SWEPT = 0.8
"""The same for the floor that either end comes over: an end is narrow."""

POINTS_A_BIN = 2
"""Fewer points in a square are noise at an edge."""


class GuardConfig(ConfigModel):
    """The space that must be free ahead of the robot."""

    margin_m: float = Field(default=0.07, ge=0.0)
    """Room that is left between the front and what is ahead, metres."""

    low_m: float = Field(default=0.1, ge=0.0)
    """What is lower than this over the foot point is floor, metres."""

    high_m: float = Field(default=0.9, gt=0.0)
    """What is higher than this passes over the robot, metres."""

    reach_m: float = Field(default=1.5, gt=0.0)
    """Nothing farther away is looked at, metres."""

    floor_reach_m: float = Field(default=2.5, gt=0.0)
    """The floor is looked for this far away, metres."""

    creep_speed: float = Field(default=0.1, gt=0.0)
    """Limit where the floor ahead has not been seen: something low may stand there, m/s."""

    memory_s: float = Field(default=30.0, gt=0.0)
    """How long what is not seen any more is remembered: the camera is blind to what is nearest,
    seconds."""

    side_margin_m: float = Field(default=0.02, ge=0.0)
    """Room that is left beside a body that turns in place, metres."""

    reaction_s: float = Field(default=0.3, ge=0.0)
    """From an image to the base slowing down, seconds."""


class ObstacleGuard:
    """Remembers what stands near the robot, until it is seen to be gone."""

    def __init__(self, config: GuardConfig, footprint: Footprint, motion: MotionConfig) -> None:
        """Keep a body free that stops as fast as `motion` says."""
        self._config, self._footprint, self._motion = config, footprint, motion
        self._seen = np.zeros((0, 4))
        """(N, 4) x, y, z of a point in each square, metres, and when it was last seen."""
        self._mapped = np.zeros((0, 2))
        self._floor = SeenFloor()
        half, grid = footprint.half_width_m, np.arange(-1.0, 1.0, 0.25)
        disc = half * np.stack(np.meshgrid(grid, grid, [0.0]), axis=-1).reshape(-1, 3)
        disc = disc[np.hypot(*disc[:, :2].T) <= half]
        along = np.zeros((len(footprint.circles()), 1, 3))
        along[:, 0, 0] = footprint.circles()
        self._below = (along + disc).reshape(-1, 3)
        """(N, 3) what the body stands on, base frame, metres."""
        self._swept = {sign: _swept(footprint, sign) for sign in (-1.0, 1.0)}
        """(2, M, 3) what either end comes over next, turning either way, base frame, metres."""

    def see(
        self,
        depth: NDArray[np.float32],
        camera: Intrinsics,
        world_from_camera: Pose,
        world_from_base: Pose,
        now_s: float,
    ) -> None:
        """Take a depth image.

        Args:
            depth: (H, W) metres, 0 where there is no return.
            camera: Its intrinsics.
            world_from_camera: Its pose.
            world_from_base: Where the robot stood, which shows that nothing else stands there.
            now_s: When it was taken, by a steady clock.
        """
        config, stride = self._config, max(1, camera.width // SAMPLED_COLUMNS)
        v, u = np.nonzero(depth[::stride, ::stride])
        z = depth[v * stride, u * stride].astype(np.float64)
        x = (u * stride - camera.cx) / camera.fx * z
        y = (v * stride - camera.cy) / camera.fy * z
        points = world_from_camera.apply(np.stack([x, y, z], axis=-1))
        foot = world_from_base.translation
        height = points[:, 2] - foot[2]
        away = np.hypot(*(points[:, :2] - foot[:2]).T)
        floor = (np.abs(height) <= config.low_m) & (away <= config.floor_reach_m)
        below = world_from_base.apply(self._below)
        self._floor.add(np.vstack([points[floor, :2], below[:, :2]]))
        near = away <= config.reach_m
        points = points[near & (height > config.low_m) & (height < config.high_m)]
        squares, first, counts = np.unique(
            np.floor(points[:, :2] / BIN_M).astype(np.int64),
            axis=0,
            return_index=True,
            return_counts=True,
        )
        new = points[first[counts >= POINTS_A_BIN]]
        kept = self._still_there(depth, camera, world_from_camera, now_s)
        seen = np.vstack([np.column_stack([new, np.full(len(new), now_s)]), kept])
        squares = np.floor(seen[:, :2] / BIN_M).astype(np.int64)
        _, newest = np.unique(squares, axis=0, return_index=True)
        self._seen = seen[newest]

    def consult(self, grid: OccupancyGrid) -> None:
        """Take the map's obstacles, which are remembered for good."""
        self._mapped = grid.center_of(np.argwhere(grid.cells == OCCUPIED))

    def free_ahead(self, pose: Pose, turn_rate: float = 0.0) -> float:
        """Metres that the body can go straight on before it touches something; at most the reach.

        Args:
            pose: Where it is.
            turn_rate: Radians a second; it is looked where this will lead as well.
        """
        headings = {pose.yaw, pose.yaw + AHEAD_S * turn_rate}
        return min(self._free_along(pose.translation[:2], heading) for heading in headings)

    def limit(self, pose: Pose, turn_rate: float = 0.0) -> float:
        """The greatest speed (m/s) from which the robot can still stop in time."""
        fastest = math.inf if self._sees_floor(pose) else self._config.creep_speed
        ahead = self.free_ahead(pose, turn_rate)
        if ahead >= self._config.reach_m:
            return fastest
        free = ahead - self._config.margin_m
        if free <= 0.0:
            return 0.0
        return min(fastest, self._stoppable(free, self._motion.acceleration))

    def turn_limit(self, pose: Pose, turn_rate: float) -> float:
        """The greatest rate (radians a second) at which the body can turn that way and still stop.

        A round body turns freely. Of a longer one the ends sweep past what is beside it.

        Args:
            pose: Where it is.
            turn_rate: The rate that is wanted, whose sign is the way.
        """
        if self._footprint.end_m == 0.0:
            return math.inf
        ends = self._swept[math.copysign(1.0, turn_rate)]
        seen = min(self._floor.share(pose.apply(end)[:, :2]) for end in ends)
        creep = self._config.creep_speed / self._footprint.turning_radius_m
        fastest = math.inf if seen > LEAST_SWEPT else creep
        margin_m = self._config.side_margin_m
        # A mapped obstacle's surface is on average half a cell inside its cell.
        free = min(
            self._free_turn(pose, turn_rate, points, margin)
            for points, margin in ((self._seen[:, :2], margin_m), (self._mapped, margin_m - BIN_M))
        )
        return min(fastest, self._stoppable(free, self._motion.turn_acceleration))

    def _free_turn(
        self, pose: Pose, turn_rate: float, points: NDArray[np.float64], margin_m: float
    ) -> float:
        """Radians that the body, grown by a margin, can turn before it touches (N, 2) points."""
        body = self._footprint
        room = body.grown(margin_m)
        aside = points - pose.translation[:2]
        away = np.hypot(*aside.T)
        near = (away > room.half_width_m) & (away < room.turning_radius_m)
        if not near.any():
            return math.inf
        away, bearing = away[near], np.arctan2(aside[near, 1], aside[near, 0]) - pose.yaw
        # Both ends sweep alike: bearings count from either, in the direction of the turn.
        ahead = np.remainder(math.copysign(1.0, turn_rate) * bearing, math.pi)
        own = body.half_angle_at(away)
        outside = (ahead >= own) & (ahead <= math.pi - own)  # else noise: there is the body
        free = ahead[outside] - room.half_angle_at(away[outside])
        return max(0.0, float(free.min(initial=math.inf)))

    def _stoppable(self, free: float, deceleration: float) -> float:
        """The speed from which the robot stops within a way or an angle, the reaction included."""
        if math.isinf(free):
            return math.inf
        a, t = deceleration, self._config.reaction_s
        return a * (math.sqrt(t * t + 2.0 * free / a) - t)

    def _sees_floor(self, pose: Pose) -> bool:
        """Whether the floor that the body comes to next has been seen."""
        body = self._footprint
        forward = body.turning_radius_m + np.array([0.05, 0.15, 0.25])
        left = body.half_width_m * np.array([-0.6, 0.0, 0.6])
        lane = np.stack(np.meshgrid(forward, left, [0.0]), axis=-1).reshape(-1, 3)
        return self._floor.share(pose.apply(lane)[:, :2]) > LEAST_SEEN

    def _free_along(self, here: NDArray[np.float64], heading: float) -> float:
        free, body = self._config.reach_m, self._footprint
        # A mapped obstacle's surface is on average half a cell inside its cell.
        for points, spared in ((self._seen[:, :2], 0.0), (self._mapped, BIN_M)):
            x, y = (points - here).T
            forward = math.cos(heading) * x + math.sin(heading) * y
            left = np.abs(math.cos(heading) * y - math.sin(heading) * x)
            lane = (left < body.half_width_m - spared) & (forward > 0.0)
            touch = forward[lane] - body.front_at(left[lane])
            free = min(free, float(touch.min(initial=math.inf)))
        return free

    def _still_there(
        self, depth: NDArray[np.float32], camera: Intrinsics, world_from_camera: Pose, now_s: float
    ) -> NDArray[np.float64]:
        """(M, 4) what was seen before but for what has grown old, or is now seen through."""
        seen = self._seen[self._seen[:, 3] > now_s - self._config.memory_s]
        x, y, z = world_from_camera.inverse().apply(seen[:, :3]).T
        before = z > 0.05
        safe_z = np.where(before, z, 1.0)
        u = np.rint(camera.fx * x / safe_z + camera.cx)
        v = np.rint(camera.fy * y / safe_z + camera.cy)
        inside = before & (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        rows, columns = np.where(inside, v, 0).astype(int), np.where(inside, u, 0).astype(int)
        gone = inside & (depth[rows, columns] > z + SEEN_THROUGH_M)
        kept: NDArray[np.float64] = seen[~gone]
        return kept


def _swept(footprint: Footprint, sign: float) -> NDArray[np.float64]:
    """(2, M, 3) what either end of a body comes over next as it turns.

    Args:
        footprint: The body.
        sign: 1 for a turn counter-clockwise, -1 for the other way.
    """
    away = np.linspace(footprint.half_width_m, footprint.turning_radius_m, 4)[1:]
    off = footprint.half_angle_at(away)[:, None] + np.array(SWEPT_RAD)
    x, y = away[:, None] * np.cos(sign * off), away[:, None] * np.sin(sign * off)
    front = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return np.stack([front, -front])
