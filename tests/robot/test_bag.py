"""Bags: what was written is read again, of ROS 1 as of ROS 2; damage gives one clear line."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from toponav.cli.main import BAD_USAGE, main
from toponav.errors import RecordingError
from toponav.evaluation.mapping_run import map_recording
from toponav.geometry import Pose
from toponav.robot.bag_import import TRANSFORM_DEFINITION, TRANSFORM_TYPE
from toponav.robot.bag_recording import is_bag, open_bag
from toponav.robot.bag_writer import BagWriter
from toponav.robot.config import RobotConfig, navigator_config, robot_config
from toponav.robot.frames import camera_mount
from toponav.robot.sim_env import RobotEnv
from toponav.scenes.loading import load_scene

pytest.importorskip("rosbags", reason="needs the extra bags")

FRAMES = 6

LIFT = Pose.from_yaw(0.3, (0.1, 0.0, 0.3))
"""Any frame between the base and the camera."""


def stamp(types, name: str, time_s: float):
    return types[name](sec=int(time_s), nanosec=round((time_s % 1.0) * 1e9))


class Messages:
    """The messages of a robot that turns in place, in either of ROS's generations."""

    def __init__(self, *, ros1: bool) -> None:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.ros1 = ros1
        self.store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_KILTED)
        of_tf = TRANSFORM_DEFINITION, TRANSFORM_TYPE
        self.store.register(get_types_from_msg(*of_tf))
        self.robot = RobotConfig()
        self.env = RobotEnv(load_scene("generated:6"), self.robot, (80, 60))
        episode = self.env.episode()
        start = (*episode.start, episode.yaw)
        self.env.reset(seed=0, options={"target": episode.target, "start": start})
        self.poses: list[Pose] = []

    def header(self, time_s: float, frame: str = "odom"):
        types = self.store.types
        more = {"seq": 0} if self.ros1 else {}
        at = stamp(types, "builtin_interfaces/msg/Time", time_s)
        return types["std_msgs/msg/Header"](stamp=at, frame_id=frame, **more)

    def odometry(self, time_s: float):
        types = self.store.types
        pose = Pose.from_yaw(self.env.yaw, self.env.position)
        x, y, z, w = map(float, pose.quaternion_xyzw)
        point = types["geometry_msgs/msg/Point"](*map(float, pose.translation))
        turn = types["geometry_msgs/msg/Quaternion"](x, y, z, w)
        zero = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
        return types["nav_msgs/msg/Odometry"](
            header=self.header(time_s),
            child_frame_id="base_link",
            pose=types["geometry_msgs/msg/PoseWithCovariance"](
                pose=types["geometry_msgs/msg/Pose"](position=point, orientation=turn),
                covariance=np.zeros(36),
            ),
            twist=types["geometry_msgs/msg/TwistWithCovariance"](
                twist=types["geometry_msgs/msg/Twist"](linear=zero, angular=zero),
                covariance=np.zeros(36),
            ),
        )

    def image(self, time_s: float, encoding: str, pixels: np.ndarray):
        return self.store.types["sensor_msgs/msg/Image"](
            header=self.header(time_s),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=pixels.strides[0],
            data=np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8),
        )

    def info(self, time_s: float):
        types, camera = self.store.types, self.env.intrinsics
        roi = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        names = {"d": np.zeros(5), "k": camera.matrix.ravel(), "r": np.eye(3).ravel()}
        names["p"] = np.zeros(12)
        matrices = {key.upper() if self.ros1 else key: value for key, value in names.items()}
        return types["sensor_msgs/msg/CameraInfo"](
            header=self.header(time_s, "camera_color_optical_frame"),
            height=camera.height,
            width=camera.width,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=roi,
            **matrices,
        )

    def transforms(self, time_s: float):
        """Where the camera sits, over a frame between."""
        types = self.store.types
        mount = camera_mount(self.robot.camera)
        links = []
        for parent, child, pose in (
            ("base_footprint", "trunk", LIFT),
            ("trunk", "camera_color_optical_frame", LIFT.inverse() @ mount),
        ):
            header = self.header(time_s, parent)
            place = types["geometry_msgs/msg/Vector3"](*map(float, pose.translation))
            turn = types["geometry_msgs/msg/Quaternion"](*map(float, pose.quaternion_xyzw))
            transform = types["geometry_msgs/msg/Transform"](translation=place, rotation=turn)
            stamped = types["geometry_msgs/msg/TransformStamped"]
            links.append(stamped(header=header, child_frame_id=child, transform=transform))
        return types["tf2_msgs/msg/TFMessage"](transforms=links)

    def __iter__(self):
        """(topic, time, message) of each."""
        camera = self.robot.camera
        names = [instance.category for instance in self.env.scene.mesh.instances]
        string = self.store.types["std_msgs/msg/String"](data=json.dumps(names))
        yield camera.names_topic, 1.0, string
        yield "tf_static", 1.0, self.transforms(1.0)
        yield self.robot.pose_topic, 1.0, self.odometry(1.0)
        for k in range(FRAMES):
            time_s = 2.0 + k
            self.env.drive(0.0, 0.5)
            seen = self.env.look()
            ids = self.env.semantic_frame().instance_ids.astype(np.int32)
            millimetres = np.round(seen.depth * 1000.0).astype(np.uint16)
            yield self.robot.pose_topic, time_s, self.odometry(time_s)
            yield camera.info_topic, time_s, self.info(time_s)
            yield camera.color_topic, time_s, self.image(time_s, "rgb8", seen.rgb)
            yield camera.labels_topic, time_s, self.image(time_s, "32SC1", ids)
            yield camera.depth_topic, time_s, self.image(time_s, "16UC1", millimetres)
            self.poses.append(Pose.from_yaw(self.env.yaw, self.env.position))


@pytest.fixture(scope="module")
def bags(tmp_path_factory) -> SimpleNamespace:
    """The same drive as a ROS 1 bag and as a rosbag2."""
    from rosbags.rosbag1 import Writer

    folder = tmp_path_factory.mktemp("bags")
    two, messages = folder / "two", Messages(ros1=False)
    with BagWriter(two) as bag:
        for topic, time_s, message in messages:
            kind = message.__msgtype__
            data = bytes(messages.store.serialize_cdr(message, kind))
            bag.write(f"/{topic}", kind, time_s, data)
    one, old = folder / "one.bag", Messages(ros1=True)
    with Writer(one) as bag:
        connections = {}
        for topic, time_s, message in old:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = bag.add_connection(f"/{topic}", kind, typestore=old.store)
            data = old.store.serialize_ros1(message, kind)
            bag.write(connections[topic], round(time_s * 1e9), data)
    return SimpleNamespace(one=one, two=two, poses=messages.poses)


def test_every_frame_comes_back_at_its_pose(bags) -> None:
    recording = open_bag(bags.two, RobotConfig())
    frames = list(recording)
    assert len(frames) == len(recording) == FRAMES
    for frame, pose in zip(frames, bags.poses, strict=True):
        np.testing.assert_allclose(frame.world_from_base.matrix, pose.matrix, atol=1e-9)


def test_a_camera_placed_by_tf_sees_the_same_as_one_placed_by_the_robot_s_file(bags) -> None:
    by_tf = robot_config("generic", {"camera": {"extrinsics": "tf", "xyz": (9.0, 9.0, 9.0)}})
    for path in (bags.one, bags.two):
        for told, fixed in zip(open_bag(path, by_tf), open_bag(path, RobotConfig()), strict=True):
            np.testing.assert_allclose(
                told.world_from_camera.matrix, fixed.world_from_camera.matrix, atol=1e-9
            )


def test_a_frame_that_tf_does_not_tell_is_named(bags) -> None:
    robot = robot_config("generic", {"camera": {"extrinsics": "tf", "base_frame": "pelvis"}})
    with pytest.raises(RecordingError, match="no transform from pelvis to camera_color_optical"):
        list(open_bag(bags.two, robot))


def test_ros_1_and_ros_2_give_the_same_map_with_objects(bags) -> None:
    clouds = []
    for path in (bags.one, bags.two, bags.two / "two.mcap"):
        recording = open_bag(path, RobotConfig())
        run = map_recording(recording, recording.labels, navigator_config(RobotConfig()))
        clouds.append(run.view)
    for view in clouds[1:]:
        np.testing.assert_array_equal(view.scene.points, clouds[0].scene.points)
        np.testing.assert_array_equal(view.navigable.points, clouds[0].navigable.points)
    assert len(clouds[0].navigable)


def damaged(bags, folder: Path, how: str) -> Path:
    data = bytearray((bags.two / "two.mcap").read_bytes())
    path = folder / f"{how}.mcap"
    if how == "cut":
        data = data[: len(data) // 2]
    elif how == "overwritten":
        data[len(data) // 3 : len(data) // 2] = b"\xff" * (len(data) // 2 - len(data) // 3)
    else:
        data = bytearray(b"this is no bag")
    path.write_bytes(bytes(data))
    return path


@pytest.mark.parametrize("how", ["cut", "overwritten", "nonsense"])
def test_a_damaged_bag_gives_one_clear_line(bags, tmp_path, capsys, how) -> None:
    path = damaged(bags, tmp_path, how)
    assert main(["map", str(path), "--out", str(tmp_path / "map")]) == BAD_USAGE
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert str(path) in said
    assert "damaged" in said


def test_a_bag_without_the_robot_s_topics_names_those_it_has(bags) -> None:
    robot = RobotConfig(pose_topic="slam")
    with pytest.raises(RecordingError, match=r"no /slam; it has .*/odom"):
        open_bag(bags.two, robot)


def test_bags_are_told_by_their_names(bags, tmp_path) -> None:
    assert is_bag(bags.one)
    assert is_bag(bags.two)
    assert not is_bag(tmp_path)
