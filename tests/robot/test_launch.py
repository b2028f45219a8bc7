"""The launch file runs `toponav ros2` with options that it has."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from toponav.cli.main import parse
from toponav.cli.robot import Ros2

LAUNCH_FILE = Path(__file__).resolve().parents[2] / "examples" / "robot" / "find.launch.py"


def launch_modules() -> dict[str, ModuleType]:
    """As much of the package `launch` as the file takes: everything keeps what it is given."""
    names = {
        "launch": ("LaunchDescription",),
        "launch.actions": ("DeclareLaunchArgument", "ExecuteProcess"),
        "launch.conditions": ("IfCondition", "UnlessCondition"),
        "launch.substitutions": ("LaunchConfiguration",),
    }
    modules = {}
    for module, classes in names.items():
        modules[module] = ModuleType(module)
        for name in classes:
            kept = lambda *values, kind=name, **named: SimpleNamespace(  # noqa: E731
                kind=kind, values=values, **named
            )
            setattr(modules[module], name, kept)
    return modules


def test_both_ways_to_launch_are_commands_of_the_node(monkeypatch) -> None:
    for name, module in launch_modules().items():
        monkeypatch.setitem(sys.modules, name, module)
    (entities,) = runpy.run_path(str(LAUNCH_FILE))["generate_launch_description"]().values
    defaults = {e.values[0]: e.default_value for e in entities if e.kind == "DeclareLaunchArgument"}

    def text(part) -> str:
        if isinstance(part, list):
            return "".join(map(text, part))
        return part if isinstance(part, str) else defaults[part.values[0]]

    commands = [[text(part) for part in e.cmd] for e in entities if e.kind == "ExecuteProcess"]
    assert len(commands) == 2
    for command, managed in zip(commands, (False, True), strict=True):
        assert command[0] == "toponav"
        parsed = parse(command[1:])
        assert isinstance(parsed, Ros2)
        assert parsed.managed == managed
        assert parsed.robot == "generic"
        assert parsed.target is None
        assert command[-5:] == ["--ros-args", "-p", "goal:=''", "-r", "__ns:=/"]


def test_ros_arguments_are_no_options_of_other_commands(capsys) -> None:
    with pytest.raises(SystemExit):
        parse(["demo", "--ros-args", "-p", "goal:=chair"])
    assert "--ros-args" in capsys.readouterr().err
