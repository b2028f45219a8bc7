"""The bookkeeping of a large run: every episode once, in memory that does not grow with them."""

from __future__ import annotations

import json
import tracemalloc
from pathlib import Path

import pytest

from toponav.evaluation.bench_scale import ScaleConfig, bench_scale
from toponav.evaluation.evaluate import RunProgress


def nothing(progress: RunProgress) -> None:
    del progress


def test_a_benchmarks_episodes_by_64_workers_of_which_some_die(tmp_path: Path) -> None:
    """Memory is that of the results, which the driver keeps for its summary, and no more."""
    tracemalloc.start()
    figures = bench_scale(ScaleConfig(), tmp_path / "run", nothing)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    lines = (tmp_path / "run" / "episodes.jsonl").read_text().splitlines()
    keys = {(record["scene"], record["index"]) for record in map(json.loads, lines)}
    assert len(lines) == len(keys) == figures["episodes"] == 2000
    assert figures["duplicates"] == figures["lost"] == 0
    assert 50 < figures["died"] < 170  # 105 expected: 2000 episodes, some of them again
    assert figures["given_up"] <= 3  # three deaths in a row: one in 8000
    assert peak / 2000 < 8e3


def test_without_deaths_none_is_given_up(tmp_path: Path) -> None:
    figures = bench_scale(ScaleConfig(episodes=50, workers=7, deaths=0.0), tmp_path, nothing)
    assert figures["died"] == figures["given_up"] == figures["lost"] == 0


def test_real_processes_that_really_die(tmp_path: Path) -> None:
    pytest.importorskip("ray", reason="needs the extra `ray`")
    config = ScaleConfig(episodes=40, workers=2, deaths=0.1, ray=True)
    figures = bench_scale(config, tmp_path / "run", nothing)
    assert figures["duplicates"] == figures["lost"] == 0
    assert figures["given_up"] <= figures["died"] / 3
