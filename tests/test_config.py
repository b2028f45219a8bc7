"""Configurations: strict, complete, reproducible."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from pydantic import ValidationError

from toponav.config import (
    NavigatorConfig,
    config_json,
    config_sha,
    load_config,
    preset,
    with_overrides,
)
from toponav.errors import ConfigError
from toponav.evaluation.run_config import RunConfig, run_config


def test_the_preset_paper_is_the_default_values() -> None:
    assert preset("paper") == NavigatorConfig()


def test_the_presets_differ_and_name_themselves_in_the_run() -> None:
    paper, best = run_config("paper"), run_config("default")
    assert paper.navigator == preset("paper")
    assert best.navigator == preset("default") != preset("paper")
    assert (paper.preset, best.preset) == ("paper", "default")


def test_an_unknown_preset_lists_those_known() -> None:
    with pytest.raises(ConfigError, match=r"unknown preset 'papers'; known: default, paper"):
        preset("papers")


def test_the_values_of_the_paper() -> None:
    """Section IV-A of the paper; what it leaves open is not asserted here."""
    config = preset("paper")
    assert config.affordances.weight_dir == config.affordances.weight_sem == 1.0
    assert config.affordances.weight_node == config.affordances.weight_hist == 1.0
    assert config.memory.include_rooms
    assert config.memory.include_objects
    assert config.memory.include_frontiers
    assert not config.decide_on_sight


@pytest.mark.parametrize("name", ["paper", "default"])
def test_what_is_written_loads_back_equal(tmp_path: Path, name: str) -> None:
    config = with_overrides(run_config(name, seed=7), {"navigator.memory.d_merge": "2.5"})
    path = tmp_path / "config.json"
    path.write_text(config_json(config))
    assert load_config(RunConfig, path) == config
    assert config_sha(load_config(RunConfig, path)) == config_sha(config)


def test_the_hash_names_the_values_and_nothing_else() -> None:
    assert config_sha(run_config("paper")) == config_sha(run_config("paper"))
    assert len(config_sha(NavigatorConfig())) == 12
    shas = {
        config_sha(config)
        for config in (
            run_config("paper"),
            run_config("default"),
            run_config("paper", seed=1),
            run_config("paper", "frontier"),
            with_overrides(run_config("paper"), {"navigator.memory.d_merge": "2"}),
        )
    }
    assert len(shas) == 5


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"colour": 1}, "colour"),
        ({"navigator": {"memory": {"d_marge": 1.0}}}, "navigator.memory.d_marge"),
        ({"navigator": {"memory": {"d_merge": -1.0}}}, "navigator.memory.d_merge"),
        ({"env": {"width": 0}}, "env.width"),
        ([1, 2], "the whole"),
    ],
)
def test_a_wrong_key_or_value_is_named_in_one_line(
    tmp_path: Path, change: object, key: str
) -> None:
    path = tmp_path / "config.json"
    path.write_text(json.dumps(change))
    with pytest.raises(ConfigError) as error_info:
        load_config(RunConfig, path)
    message = str(error_info.value)
    assert f"{path}: {key}: " in message
    assert "\n" not in message


@pytest.mark.parametrize("content", [None, "{", b"\xff\xfe"])
def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, content: str | bytes | None) -> None:
    path = tmp_path / "config.json"
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif content is not None:
        path.write_text(content)
    with pytest.raises(ConfigError, match=r"config\.json"):
        load_config(RunConfig, path)


def test_overrides_change_what_they_name_and_nothing_else() -> None:
    config = run_config("paper")
    changed = with_overrides(
        config, {"navigator.memory.include_rooms": "false", "method": "frontier"}
    )
    assert not changed.navigator.memory.include_rooms
    assert changed.method == "frontier"
    assert config.navigator.memory.include_rooms
    back = with_overrides(changed, {"navigator.memory.include_rooms": "true", "method": "toponav"})
    assert back == config


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("navigator.nonsense", "1", "known here: affordances, counsel, decide_on_sight"),
        ("nonsense.memory.d_merge", "1", "known here: backend, detector"),
        ("navigator.memory.d_merge.deeper", "1", "unknown configuration key"),
        ("seed", "many", "seed: "),
    ],
)
def test_wrong_overrides_say_what_is_known(key: str, value: str, says: str) -> None:
    with pytest.raises(ConfigError) as error_info:
        with_overrides(run_config("paper"), {key: value})
    assert says in str(error_info.value)
    assert "\n" not in str(error_info.value)


def test_configurations_are_frozen() -> None:
    with pytest.raises(ValidationError):
        preset("paper").memory.d_merge = 3.0
