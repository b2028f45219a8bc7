"""Names of a seam, and those that a user's file brings."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from toponav.errors import InputError
from toponav.methods import methods
from toponav.perception.base import check_detector, detectors
from toponav.registry import Registry

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_an_unknown_name_lists_those_known_and_the_nearest() -> None:
    things: Registry[int] = Registry("thing")
    things.register("one")(1)
    things.register("two")(2)
    assert things.get("two") == 2
    with pytest.raises(InputError, match=r"unknown thing 'tow' \(did you mean 'two'\?\); known: o"):
        things.get("tow")


@pytest.fixture(autouse=True)
def _as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a test registers is gone after it."""
    for registry in (methods, detectors):
        monkeypatch.setattr(registry, "_entries", dict(registry._entries))
    monkeypatch.setattr(sys, "modules", dict(sys.modules))


def test_a_file_brings_a_method_of_its_own_once() -> None:
    name = f"{EXAMPLES / '02_own_agent.py'}:wall-follower"
    assert methods.get(name) is methods.get(name)
    with pytest.raises(InputError, match="unknown method 'wall-climber'"):
        methods.get(name.replace("follower", "climber"))


def test_a_file_brings_a_detector() -> None:
    check_detector(f"{EXAMPLES / '03_own_detector.py'}:green")


def test_a_file_that_fails_says_why(tmp_path: Path) -> None:
    broken = tmp_path / "broken.py"
    with pytest.raises(InputError, match=r"there is no file .*broken\.py"):
        methods.get(f"{broken}:mine")
    broken.write_text("import nothing_of_that_name\n")
    with pytest.raises(InputError, match=r"broken\.py fails: ModuleNotFoundError"):
        methods.get(f"{broken}:mine")
