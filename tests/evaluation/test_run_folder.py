"""A run's folder: what may change between a run and its resumption, and what may not."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from small_house import small_config
from toponav.config import load_config
from toponav.errors import ConfigError, InputError
from toponav.evaluation.blank_worker import BlankWorker
from toponav.evaluation.crew import Outcome
from toponav.evaluation.run_config import RunConfig
from toponav.evaluation.run_folder import FREE_TO_CHANGE, RunFolder, RunRequest
from toponav.evaluation.tasks import Task
from toponav.files import discard_temporaries, temporary_beside, write_atomic

CONFIG, REQUEST = small_config(), RunRequest(source="generated:0-3", episodes=8)
TASK = Task("spec", "scene", 0)
OUTCOME = Outcome(TASK, BlankWorker().run(TASK))


@pytest.fixture
def begun(tmp_path: Path) -> Path:
    """The folder of a run that ended after one episode."""
    run = RunFolder(tmp_path)
    with run.opened(REQUEST, CONFIG, resume=False):
        run.keep(OUTCOME)
    return tmp_path


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def resume(folder: Path, request: RunRequest = REQUEST, config: RunConfig = CONFIG) -> None:
    with RunFolder(folder).opened(request, config, resume=True):
        pass


def test_a_run_leaves_its_request_and_its_configuration(begun: Path) -> None:
    assert load_config(RunConfig, begun / "config.json") == CONFIG
    assert load_config(RunRequest, begun / "run.json") == REQUEST
    assert RunFolder(begun).journal.results() == [OUTCOME.result]
    assert set(content(begun)) == {"config.json", "run.json", "episodes.jsonl"}


def test_episodes_are_never_written_over(begun: Path) -> None:
    before = content(begun)
    with (
        pytest.raises(InputError, match=r"episodes\.jsonl exists: --resume goes on"),
        RunFolder(begun).opened(REQUEST, CONFIG, resume=False),
    ):
        raise AssertionError("it was opened")
    assert content(begun) == before


def test_resuming_what_never_began_begins_it(tmp_path: Path) -> None:
    resume(tmp_path)
    assert load_config(RunConfig, tmp_path / "config.json") == CONFIG


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"seed": 7}, "seed was 0, is 7"),
        ({"method": "random"}, "method was 'toponav', is 'random'"),
        ({"env": CONFIG.env.model_copy(update={"max_steps": 9})}, "env.max_steps was 200, is 9"),
    ],
)
def test_another_configuration_is_refused_by_its_dotted_keys(
    begun: Path, changed: dict[str, Any], says: str
) -> None:
    before = content(begun)
    with pytest.raises(ConfigError, match=f"cannot resume {re.escape(str(begun))}: {says}; use"):
        resume(begun, config=CONFIG.model_copy(update=changed))
    assert content(begun) == before


def test_every_difference_is_named(begun: Path) -> None:
    memory = CONFIG.navigator.memory.model_copy(update={"d_merge": 9.5})
    navigator = CONFIG.navigator.model_copy(update={"memory": memory})
    config = CONFIG.model_copy(update={"seed": 3, "navigator": navigator})
    with pytest.raises(ConfigError) as caught:
        resume(begun, config=config)
    d_merge = CONFIG.navigator.memory.d_merge
    assert f"navigator.memory.d_merge was {d_merge}, is 9.5; seed was 0, is 3" in str(caught.value)


def test_another_source_is_refused(begun: Path) -> None:
    with pytest.raises(ConfigError, match="source was 'generated:0-3', is 'generated:9'"):
        resume(begun, RunRequest(source="generated:9", episodes=8))
    relabelled = REQUEST.model_copy(update={"labels": Path("labels.json")})
    with pytest.raises(ConfigError, match=r"labels was None, is 'labels\.json'"):
        resume(begun, relabelled)


def test_how_many_by_whom_and_where_may_change_and_is_written_down(begun: Path) -> None:
    free = {
        "episodes": 9, "data": Path("/elsewhere"), "only": "other-floor", "shard": "1/2",
        "workers": 5, "ray_address": "10.0.0.1:6379", "record": False, "explain": False,
        "cache": Path("/cache"), "max_cost": 2.0,
    }  # fmt: skip
    assert set(free) == FREE_TO_CHANGE
    request = RunRequest(source=REQUEST.source, **free)  # type: ignore[arg-type]
    assert all(getattr(request, key) != getattr(REQUEST, key) for key in free)
    resume(begun, request)
    assert load_config(RunRequest, begun / "run.json") == request
    assert RunFolder(begun).journal.results() == [OUTCOME.result]


@pytest.mark.parametrize("name", ["config.json", "run.json"])
@pytest.mark.parametrize("damage", [lambda path: path.unlink(), lambda path: path.write_text("{")])
def test_without_knowing_what_was_run_nothing_is_added_to_it(
    begun: Path, name: str, damage: Any
) -> None:
    damage(begun / name)
    before = content(begun)
    with pytest.raises(ConfigError, match=rf"cannot resume: \S*{name} cannot be read"):
        resume(begun)
    assert content(begun) == before


def test_what_a_kill_left_half_written_is_cleared_away(begun: Path) -> None:
    whole = content(begun)
    temporary_beside(begun / "summary.json").write_text("{")
    with (begun / "episodes.jsonl").open("a") as stream:
        stream.write('{"scene": "sc')
    resume(begun)
    assert content(begun) == whole


def test_only_temporaries_are_cleared_away(tmp_path: Path) -> None:
    kept = tmp_path / ".hidden.json"
    write_atomic(kept, "mine")
    temporary_beside(tmp_path / "memory.json").touch()
    discard_temporaries(tmp_path)
    assert list(tmp_path.iterdir()) == [kept]


def test_the_summary_is_json_also_where_a_number_is_infinite(tmp_path: Path) -> None:
    RunFolder(tmp_path).conclude({"dtg": float("inf"), "n": 1})
    assert json.loads((tmp_path / "summary.json").read_text()) == {"dtg": None, "n": 1}
