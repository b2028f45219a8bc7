"""What is told while something runs: a live line in a terminal, plain lines elsewhere."""

from __future__ import annotations

import io
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from made_results import made_result
from toponav.cli.console import Output
from toponav.cli.progress import EpisodeDisplay, RunDisplay


def told(terminal: bool, quiet: bool = False) -> tuple[Output, io.StringIO]:
    """An output whose progress goes into a text."""
    text = io.StringIO()
    output = Output(as_json=False, quiet=quiet)
    output.progress = Console(
        file=text, force_terminal=terminal, width=120, quiet=quiet, soft_wrap=True
    )
    return output, text


def show_episode(output: Output) -> None:
    with EpisodeDisplay(output, max_steps=500) as display:
        display.enter("exploration")
        display.advance(step=40, walked_m=6.25)
        display._bar.refresh()


def test_in_a_terminal_an_episode_tells_its_stage_steps_and_metres() -> None:
    output, text = told(terminal=True)
    show_episode(output)
    for words in ("getting ready", "exploration", "40/500", "6.2 m walked", "left"):
        assert words in text.getvalue()


@pytest.mark.parametrize(("terminal", "quiet"), [(False, False), (True, True)])
def test_elsewhere_and_when_quiet_nothing_moves(terminal: bool, quiet: bool) -> None:
    output, text = told(terminal, quiet)
    show_episode(output)
    assert text.getvalue() == ""


def progress(done: int) -> Any:
    results = [made_result(index=k) for k in range(done)]
    outcome = SimpleNamespace(result=results[-1]) if results else None
    return SimpleNamespace(done=done, total=3, results=results, outcome=outcome)


def test_without_a_terminal_each_episode_is_a_line() -> None:
    output, text = told(terminal=False)
    with RunDisplay(output) as display:
        for done in range(4):
            display.on_progress(progress(done))
    lines = text.getvalue().splitlines()
    assert [line.partition(" ")[0] for line in lines] == ["[1/3]", "[2/3]", "[3/3]"]
    assert "SR " in lines[0]


def test_in_a_terminal_a_run_has_a_bar_and_no_lines() -> None:
    output, text = told(terminal=True)
    with RunDisplay(output) as display:
        display.on_progress(progress(2))
    assert "2/3" in text.getvalue()
    assert "[2/3]" not in text.getvalue()
