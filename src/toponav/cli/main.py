"""The command line: parses, runs one command, and turns errors into exit codes.

0: the command did its work (an episode that does not find its object is a result, not a failure);
1: a run failed; 2: bad usage or bad input, said in one line.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Annotated

import tyro

from toponav.cli.bench import Bench
from toponav.cli.demo import Demo
from toponav.cli.episodes import Episodes
from toponav.cli.eval import Eval
from toponav.cli.map import Map
from toponav.cli.reasoner import ReasonerCommand
from toponav.cli.render import Render
from toponav.cli.report import Report
from toponav.cli.robot import Record, Ros2, SimRobotCommand
from toponav.cli.run import Run
from toponav.cli.scenes import Scenes
from toponav.cli.study import Study
from toponav.cli.table import Table
from toponav.errors import InputError, TopoNavError
from toponav.registry import unknown

Command = (
    Annotated[Demo, tyro.conf.subcommand("demo")]
    | Annotated[Run, tyro.conf.subcommand("run")]
    | Annotated[Eval, tyro.conf.subcommand("eval")]
    | Annotated[Study, tyro.conf.subcommand("study")]
    | Annotated[Table, tyro.conf.subcommand("table")]
    | Annotated[Report, tyro.conf.subcommand("report")]
    | Annotated[Render, tyro.conf.subcommand("render")]
    | Annotated[Episodes, tyro.conf.subcommand("episodes")]
    | Annotated[ReasonerCommand, tyro.conf.subcommand("reasoner")]
    | Annotated[Map, tyro.conf.subcommand("map")]
    | Annotated[Scenes, tyro.conf.subcommand("scenes")]
    | Annotated[Ros2, tyro.conf.subcommand("ros2")]
    | Annotated[SimRobotCommand, tyro.conf.subcommand("sim-robot")]
    | Annotated[Record, tyro.conf.subcommand("record")]
    | Annotated[Bench, tyro.conf.subcommand("bench")]
)

COMMANDS = (
    "demo", "run", "eval", "study", "table", "report", "render", "episodes", "reasoner", "map",
    "scenes", "ros2", "sim-robot", "record", "bench",
)  # fmt: skip

OK, FAILED_RUN, BAD_USAGE = 0, 1, 2
ROS_COMMANDS = ("ros2", "sim-robot", "record")
"""Commands whose `--ros-args` (remappings, parameters) rclpy reads from the process's arguments."""

INTERRUPTED = 130
"""What shells expect after Ctrl-C: 128 + SIGINT."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit code. Usage errors of the parser exit with 2."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words == ["--version"]:
        sys.stdout.write(f"toponav {version('toponav')}\n")
        return OK
    try:
        parse(words).run()
    except InputError as error:
        return _report(error, BAD_USAGE)
    except TopoNavError as error:
        return _report(error, FAILED_RUN)
    except BrokenPipeError:
        raise
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        return _report(f"cannot read or write{where}: {error.strerror or error}", FAILED_RUN)
    except KeyboardInterrupt:
        return _report("interrupted; what was finished has been written", INTERRUPTED)
    return OK


def parse(arguments: Sequence[str]) -> Command:
    """The command that arguments ask for, not yet run; wrong options exit with 2.

    Raises:
        InputError: They name no command, or none that there is.
    """
    if not arguments:
        raise InputError(f"give a command: {', '.join(COMMANDS)}; or --help")
    if not arguments[0].startswith("-") and arguments[0] not in COMMANDS:
        raise unknown("command", arguments[0], COMMANDS)
    if "--ros-args" in arguments and arguments[0] in ROS_COMMANDS:
        arguments = arguments[: arguments.index("--ros-args")]
    return tyro.cli(
        Command,
        prog="toponav",
        description="Find an object named by a category in a building never seen before.",
        args=arguments,
        config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.OmitArgPrefixes),
    )


def _report(error: object, exit_code: int) -> int:
    """One line on stderr."""
    sys.stderr.write(f"toponav: {' '.join(str(error).split())}\n")
    return exit_code


def entry_point() -> None:
    """The `toponav` console script."""
    try:
        code = main()
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader, `head` perhaps, has seen enough; what is still to be flushed goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = OK
    sys.exit(code)
