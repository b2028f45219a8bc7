"""Bags of ROS 1 and ROS 2 as recordings of posed RGB-D images; no ROS is needed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from toponav.errors import PoseError, RecordingError
from toponav.robot.bag_import import import_bags, message_types
from toponav.robot.config import CameraConfig, RobotConfig
from toponav.robot.frame_sync import FrameSync
from toponav.robot.frames import (
    COLOR,
    DEPTH,
    LABELS,
    TRANSFORM_TOPICS,
    FrameReader,
    pose_of,
    seconds_of,
)
from toponav.robot.labels import LabelImageDetector
from toponav.robot.pose_buffer import PoseBuffer
from toponav.robot.pose_continuity import PoseContinuity
from toponav.types import Observation

BAG_SUFFIXES = (".bag", ".mcap", ".db3")
"""Of single files."""


def is_bag(path: Path) -> bool:
    """Whether a path is a bag's, by its name: a file, or the folder of a rosbag2."""
    return path.suffix in BAG_SUFFIXES or (path / "metadata.yaml").exists()


@dataclass(frozen=True, eq=False)
class BagRecording:
    """A bag; iterating reads it from the start.

    Attributes:
        path: The bag.
        robot: Whose topics are read, and where its camera sits.
        labels: Shown the label image of each observation, where the bag has any; else None.
        images: Depth images in the bag; fewer observations may come of them.
    """

    path: Path
    robot: RobotConfig
    labels: LabelImageDetector | None
    images: int

    def __len__(self) -> int:
        return self.images

    def __iter__(self) -> Iterator[Observation]:
        """Every instant of which all images and the pose are there.

        Raises:
            RecordingError: The bag is damaged, or there is no such instant.
        """
        reader = FrameReader(self.robot.camera, self.labels)
        motion = self.robot.motion
        continuity = PoseContinuity(motion.max_speed, motion.max_turn_rate)
        poses, frames = PoseBuffer(), FrameSync(reader.kinds, self.robot.camera.slop_s)
        found = 0
        for topic, message in _messages(self.path, _topics(self.robot, reader.kinds)):
            if topic == _rooted(self.robot.camera.info_topic):
                reader.take_info(message)
            elif topic == _rooted(self.robot.camera.names_topic):
                reader.take_names(message)
            elif topic in TRANSFORM_TOPICS:
                reader.take_transforms(message)
            elif topic == _rooted(self.robot.pose_topic):
                stamp_s = seconds_of(message.header.stamp)
                if poses.newest_s is None or stamp_s > poses.newest_s:
                    try:
                        pose, _ = continuity.add(stamp_s, pose_of(message))
                    except PoseError:
                        continue  # as the node does
                    poses.add(stamp_s, pose)
            else:
                kind = _kind(self.robot.camera, topic)
                frames.add(kind, seconds_of(message.header.stamp), message)
            while not reader.lacks and (instant := frames.oldest(poses)) is not None:
                yield reader.observation(instant)
                found += 1
        if not found:
            why = reader.lacks or "no images with a pose at their time"
            raise RecordingError(f"{self.path} holds no posed RGB-D image: {why}")


def open_bag(path: Path, robot: RobotConfig) -> BagRecording:
    """Open a bag.

    Raises:
        MissingExtraError: rosbags is not installed.
        RecordingError: It is damaged, or lacks a topic; the message names those it has.
    """
    counts = _counts(path)
    camera = robot.camera
    wanted = (camera.depth_topic, camera.color_topic, camera.info_topic, robot.pose_topic)
    for topic in wanted:
        if _rooted(topic) not in counts:
            known = ", ".join(sorted(counts)) or "nothing"
            raise RecordingError(
                f"{path} has no {_rooted(topic)}; it has {known}: name its topics in a file for "
                "--robot"
            )
    has_labels = _rooted(camera.labels_topic) in counts and _rooted(camera.names_topic) in counts
    labels = LabelImageDetector() if has_labels else None
    return BagRecording(path, robot, labels, counts[_rooted(camera.depth_topic)])


def _counts(path: Path) -> dict[str, int]:
    """Messages on each topic."""
    reader = import_bags("rosbags.highlevel").AnyReader
    if not path.exists():
        raise RecordingError(f"there is no bag {path}")
    try:
        with reader([path], default_typestore=message_types()) as bag:
            return {topic: info.msgcount for topic, info in bag.topics.items()}
    except Exception as error:  # a damaged file may break anything in its reader
        raise _damaged(path, error) from error


def _messages(path: Path, topics: set[str]) -> Iterator[tuple[str, Any]]:
    """Messages of some topics in the order in which they were recorded."""
    reader = import_bags("rosbags.highlevel").AnyReader
    try:
        with reader([path], default_typestore=message_types()) as bag:
            chosen = [c for c in bag.connections if c.topic in topics]
            for connection, _, data in bag.messages(connections=chosen):
                yield connection.topic, bag.deserialize(data, connection.msgtype)
    except RecordingError:
        raise
    except GeneratorExit:
        raise
    except Exception as error:
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> RecordingError:
    why = " ".join(str(error).split()) or type(error).__name__
    return RecordingError(f"{path} is damaged or no bag: {why[:200]}")


def _topics(robot: RobotConfig, kinds: tuple[str, ...]) -> set[str]:
    camera = robot.camera
    topics = {camera.depth_topic, camera.color_topic, camera.info_topic, robot.pose_topic}
    if camera.extrinsics == "tf":
        topics |= set(TRANSFORM_TOPICS)
    if LABELS in kinds:
        topics |= {camera.labels_topic, camera.names_topic}
    return {_rooted(topic) for topic in topics}


def _kind(camera: CameraConfig, topic: str) -> str:
    kinds = {camera.depth_topic: DEPTH, camera.color_topic: COLOR, camera.labels_topic: LABELS}
    return next(kind for name, kind in kinds.items() if _rooted(name) == topic)


def _rooted(topic: str) -> str:
    """A topic's full name in the root namespace."""
    return topic if topic.startswith("/") else f"/{topic}"
