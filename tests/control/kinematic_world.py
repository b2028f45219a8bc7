"""A flat world of boxes and a disc that walks in it: the protocol's motion, without sliding."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from toponav.control.locomotion import Locomotion, LocomotionConfig, Progress
from toponav.geometry import Intrinsics, Pose
from toponav.mapping.view import FREE, OCCUPIED, OccupancyGrid
from toponav.types import Action, Observation

RADIUS_M, FORWARD_M, TURN_RAD = 0.18, 0.25, math.radians(30.0)
CONTACT_SAMPLES = 125
"""A step is cut to 2 mm."""

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class BoxWorld:
    """Boxes (B, 4) of x_min, y_min, x_max, y_max in a rectangle that starts at the origin."""

    size: tuple[float, float]
    boxes: FloatArray

    def clearance(self, xy: ArrayLike) -> FloatArray:
        """(N,) distance of (N, 2) points to the nearest box."""
        point = np.atleast_2d(np.asarray(xy, np.float64))[:, None]
        outside = np.maximum(np.maximum(self.boxes[:, :2] - point, point - self.boxes[:, 2:]), 0.0)
        return np.asarray(np.hypot(outside[..., 0], outside[..., 1]).min(axis=1))

    def grid(self, resolution: float = 0.1, offset: ArrayLike = (0.0, 0.0)) -> OccupancyGrid:
        """Every cell that a box touches is occupied, as a map of surface points would have it."""
        origin = np.asarray(offset, np.float64) - resolution
        shape = np.ceil((np.asarray(self.size) - origin) / resolution).astype(int) + 1
        cells = np.full(shape, FREE, np.int8)
        low = np.floor((self.boxes[:, :2] - origin) / resolution + 1e-9).astype(int)
        high = np.ceil((self.boxes[:, 2:] - origin) / resolution - 1e-9).astype(int)
        for (i0, j0), (i1, j1) in zip(np.maximum(low, 0), np.maximum(high, 0), strict=True):
            cells[i0:i1, j0:j1] = OCCUPIED
        return OccupancyGrid(cells, (float(origin[0]), float(origin[1])), resolution)


@dataclass
class Walker:
    """The disc: 0.25 m steps that end at the first contact, 30 degree turns."""

    world: BoxWorld
    xy: FloatArray
    yaw: float
    collided: bool = False
    steps: int = 0
    collisions: int = 0
    length_m: float = 0.0
    actions: list[Action] = field(default_factory=list)

    def observe(self) -> Observation:
        return Observation(
            np.zeros((1, 1, 3), np.uint8),
            np.zeros((1, 1), np.float32),
            Pose.identity(),
            Pose.from_yaw(self.yaw, (*self.xy, 0.0)),
            Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0),
            collided=self.collided,
            step=self.steps,
        )

    def apply(self, action: Action) -> None:
        self.steps += 1
        self.actions.append(action)
        self.collided = False
        if action is Action.TURN_LEFT:
            self.yaw += TURN_RAD
        elif action is Action.TURN_RIGHT:
            self.yaw -= TURN_RAD
        else:
            assert action is Action.MOVE_FORWARD
            self._forward()

    def _forward(self) -> None:
        fraction = np.arange(1, CONTACT_SAMPLES + 1) / CONTACT_SAMPLES
        direction = np.array([math.cos(self.yaw), math.sin(self.yaw)])
        ahead = self.xy + fraction[:, None] * FORWARD_M * direction
        blocked = self.world.clearance(ahead) < RADIUS_M
        free = int(np.argmax(blocked)) if blocked.any() else CONTACT_SAMPLES
        if free < CONTACT_SAMPLES:
            self.collided = True
            self.collisions += 1
        if free:
            self.length_m += float(np.hypot(*(ahead[free - 1] - self.xy)))
            self.xy = ahead[free - 1]


def rooms(rng: np.random.Generator, columns: int, rows: int, door: tuple[float, float]) -> BoxWorld:
    """A maze of rooms: a random spanning tree of doors, and some more."""
    wall = 0.12
    xs = np.concatenate([[0.0], np.cumsum(rng.uniform(1.8, 4.0, columns))])
    ys = np.concatenate([[0.0], np.cumsum(rng.uniform(1.8, 4.0, rows))])
    pairs = [((c, r), (c + 1, r)) for c in range(columns - 1) for r in range(rows)]
    pairs += [((c, r), (c, r + 1)) for c in range(columns) for r in range(rows - 1)]
    component = {(c, r): (c, r) for c in range(columns) for r in range(rows)}
    boxes = [
        (-wall, -wall, xs[-1] + wall, wall / 2),
        (-wall, ys[-1] - wall / 2, xs[-1] + wall, ys[-1] + wall),
        (-wall, -wall, wall / 2, ys[-1] + wall),
        (xs[-1] - wall / 2, -wall, xs[-1] + wall, ys[-1] + wall),
    ]
    for k in rng.permutation(len(pairs)):
        (c, r), other = pairs[k]
        joined = component[c, r] == component[other]
        if not joined:
            old = component[other]
            component.update(
                {cell: component[c, r] for cell in component if component[cell] == old}
            )
        open_ = not joined or rng.random() < 0.15
        vertical = other[0] > c
        low, high = (ys[r], ys[r + 1]) if vertical else (xs[c], xs[c + 1])
        at = xs[c + 1] if vertical else ys[r + 1]
        spans = [(low, high)]
        if open_:
            width = rng.uniform(*door)
            begin = rng.uniform(low + wall, high - wall - width)
            spans = [(low, begin), (begin + width, high)]
        for a, b in spans:
            across = (at - wall / 2, at + wall / 2)
            box = (across[0], a, across[1], b) if vertical else (a, across[0], b, across[1])
            boxes.append(box)
    return BoxWorld((float(xs[-1]), float(ys[-1])), np.array(boxes))


def furnished(rng: np.random.Generator, world: BoxWorld, pieces: int) -> BoxWorld:
    """The same rooms with boxes of 0.3 to 1.2 m put anywhere, doors included."""
    low = rng.uniform((0.0, 0.0), world.size, (pieces, 2))
    added = np.hstack([low, low + rng.uniform(0.3, 1.2, (pieces, 2))])
    return BoxWorld(world.size, np.vstack([world.boxes, added]))


def standing_point(rng: np.random.Generator, world: BoxWorld, margin: float) -> FloatArray:
    while True:
        xy = rng.uniform((0.0, 0.0), world.size)
        if world.clearance(xy)[0] > margin:
            return np.asarray(xy)


def walk(walker: Walker, grid: OccupancyGrid, goal: ArrayLike, max_steps: int = 500) -> Progress:
    """Walk to a goal on a map that does not change."""
    locomotion = Locomotion(LocomotionConfig())
    locomotion.go_to(np.asarray(goal))
    while walker.steps < max_steps:
        observation = walker.observe()
        locomotion.observe(observation)
        action = locomotion.next_action(observation, grid)
        if action is None:
            break
        walker.apply(action)
    return locomotion.progress
