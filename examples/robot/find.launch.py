"""The search as a process of `ros2 launch`, where a ROS 2 is installed.

    ros2 launch examples/robot/find.launch.py robot:=go2.yaml detector:=onnx:yolox_nano.onnx
    ros2 param set /toponav goal chair

`target:=chair` starts at once; `managed:=true` waits for a lifecycle manager, such as Nav2's.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration

OPTIONS = {
    "robot": ("generic", "Profile, or the robot's YAML file."),
    "drive": ("cmd_vel", "cmd_vel, or goal_pose for Nav2."),
    "detector": ("labels", "onnx:MODEL.onnx, or labels for images that another node publishes."),
    "memory": ("building.npz", "What is known of the building, kept from run to run."),
}
"""Options of `toponav ros2` that are arguments here, with their defaults."""

OTHERS = {
    "target": ("", "What to find at once; empty waits for goals."),
    "namespace": ("/", "Of the node and its topics."),
    "managed": ("false", "Whether a lifecycle manager configures and activates the node."),
}


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` runs."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=about)
        for name, (default, about) in (OPTIONS | OTHERS).items()
    ]
    options = [part for name in OPTIONS for part in (f"--{name}", LaunchConfiguration(name))]
    ros = ["--ros-args", "-p", ["goal:='", LaunchConfiguration("target"), "'"]]
    ros += ["-r", ["__ns:=", LaunchConfiguration("namespace")]]
    managed = LaunchConfiguration("managed")
    # The node brakes and writes its memory before it ends.
    alone = ExecuteProcess(
        cmd=["toponav", "ros2", *options, *ros],
        output="screen",
        sigterm_timeout="20",
        condition=UnlessCondition(managed),
    )
    led = ExecuteProcess(
        cmd=["toponav", "ros2", "--managed", *options, *ros],
        output="screen",
        sigterm_timeout="20",
        condition=IfCondition(managed),
    )
    return LaunchDescription([*declared, alone, led])
