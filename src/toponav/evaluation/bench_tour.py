"""Frames on which map, decisions and memory are measured: a tour of a building, a recording."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.config import NavigatorConfig
from toponav.envs.recording import WorldAxes, open_recording
from toponav.envs.simulator import HouseEnv, HouseEnvConfig
from toponav.errors import SceneError
from toponav.perception import DetectorContext, PerceptionConfig, make_detector
from toponav.perception.base import Detector
from toponav.perception.object_masks import object_masks
from toponav.perception.oracle import OracleDetector
from toponav.scenes.furnish import furnish_room
from toponav.scenes.house import House, Level, Opening, Room
from toponav.scenes.meshing import build_scene
from toponav.types import Action, Detections, Observation

CORRIDOR_M, ROOM_WIDTH_M, ROOM_DEPTH_M = 2.4, 4.0, 5.0
ROOM_TYPES = ("office", "bedroom", "living room", "library", "kitchen", "dining room")
VIEWS = 12
"""Views of a panorama."""

TOUR_TARGET = "chair"
"""What the simulator is told to look for; the tour does not heed it."""


BOXES = (
    (0.03, 0.4, 0.35, 0.95),
    (0.4, 0.37, 0.62, 0.83),
    (0.65, 0.45, 0.97, 0.98),
    (0.15, 0.12, 0.47, 0.39),
)
"""Shares of an image's width and height: left, top, right, bottom."""


class TourFrame(NamedTuple):
    """One image of a tour.

    Attributes:
        observation: O_t.
        detections: The true labels in it.
    """

    observation: Observation
    detections: Detections


class Tour:
    """Panoramas in every room of a building and along its corridor, in the order of a walk."""

    def __init__(self, area_m2: float, width: int, height: int) -> None:
        """Lay out a building of at least that area on one storey, and furnish it."""
        slices = math.ceil(area_m2 / (ROOM_WIDTH_M * (CORRIDOR_M + 2 * ROOM_DEPTH_M)))
        self.area_m2 = slices * ROOM_WIDTH_M * (CORRIDOR_M + 2 * ROOM_DEPTH_M)
        self._slices = slices
        scene = build_scene(_building(slices), None)
        self._env = HouseEnv(scene, HouseEnvConfig(width=width, height=height))
        self._oracle = OracleDetector(self._env)
        self._vocabulary = tuple(map(canonical, NavigatorConfig().vocabulary))

    @property
    def stops(self) -> int:
        """Places at which a panorama is taken."""
        return 3 * self._slices

    def panorama(self, stop: int) -> list[TourFrame]:
        """The views of a full turn at one of the stops."""
        x = (stop // 3 + 0.5) * ROOM_WIDTH_M
        y = (0.0, CORRIDOR_M / 2 + 1.0, -CORRIDOR_M / 2 - 1.0)[stop % 3]
        start = self._env.surface.snap((x, y, 0.0), ROOM_WIDTH_M)
        if start is None:
            raise SceneError(f"nobody can stand near ({x:.1f}, {y:.1f}) of the tour's building")
        self._env.reset(options={"target": TOUR_TARGET, "start": (*start, 0.0)})
        frames = []
        for _ in range(VIEWS):
            observation = self._env.observe()
            seen = self._oracle.detect(observation.rgb, self._vocabulary)
            frames.append(TourFrame(observation, seen))
            self._env.step(Action.TURN_LEFT)
        return frames

    def __iter__(self) -> Iterator[TourFrame]:
        """All frames, rendered as they are asked for."""
        for stop in range(self.stops):
            yield from self.panorama(stop)


def recorded_frames(
    folder: Path, world: WorldAxes | None, detector: str | None, config: NavigatorConfig
) -> list[TourFrame]:
    """The frames of a recording, labelled.

    Args:
        folder: The recording.
        world: Which way is up in its world; told from the floor when left out.
        detector: Labels the images; without one, four boxes that cover 43 % of an image of
            640 x 480 stand for detections.
        config: Names the vocabulary.

    Raises:
        InputError: There is no such detector.
        RecordingError: The recording is damaged.
    """
    finder: Detector = _FourBoxes()
    if detector is not None:
        finder = make_detector(detector, DetectorContext(PerceptionConfig()))
    frames = []
    for observation in open_recording(folder, world):
        seen = finder.detect(observation.rgb, config.vocabulary)
        frames.append(TourFrame(observation, object_masks(observation, seen)))
    return frames


class _FourBoxes:
    """Stands for a detector where only the cost of its masks matters."""

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        """The same four boxes in every image, each of another category."""
        height, width = rgb.shape[:2]
        masks = np.zeros((len(BOXES), height, width), np.bool_)
        boxes = (np.array(BOXES) * (width, height, width, height)).round().astype(np.int64)
        for mask, (left, top, right, bottom) in zip(masks, boxes, strict=True):
            mask[top:bottom, left:right] = True
        return Detections(
            tuple(vocabulary[: len(BOXES)]),
            np.ones(len(BOXES), np.float32),
            boxes.astype(np.float32),
            masks,
        )


def _building(slices: int) -> House:
    """A corridor along x with a room on either side of each of its slices."""
    length = slices * ROOM_WIDTH_M
    rng = np.random.default_rng(0)
    rooms = [
        Room(
            id="corridor",
            type="hallway",
            polygon=_rectangle(0.0, length, -CORRIDOR_M / 2, CORRIDOR_M / 2),
        )
    ]
    doors = []
    for k in range(slices):
        x = k * ROOM_WIDTH_M
        for side, name in ((1.0, "north"), (-1.0, "south")):
            wall = side * CORRIDOR_M / 2
            near, far = sorted((wall, wall + side * ROOM_DEPTH_M))
            room = Room(
                id=f"{name}_{k}",
                type=ROOM_TYPES[(2 * k + (side < 0)) % len(ROOM_TYPES)],
                polygon=_rectangle(x, x + ROOM_WIDTH_M, near, far),
            )
            rooms.append(room)
            center = (x + ROOM_WIDTH_M / 2, wall)
            doors.append(Opening(kind="door", rooms=["corridor", room.id], center=center))
    objects = []
    for room in rooms:
        openings = [door for door in doors if room.id in door.rooms]
        objects += furnish_room(room, openings, 0.0, rng)
    return House(name="tour", levels=[Level(rooms=rooms, openings=doors, objects=objects)])


def _rectangle(x0: float, x1: float, y0: float, y1: float) -> list[tuple[float, float]]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
