"""Records and their summary against cases worked by hand."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.evaluation.results import (
    EpisodeResult,
    json_ready,
    score_episode,
    to_json,
)
from toponav.evaluation.summary import summarize

FOUND = EpisodeResult(
    scene="s", index=0, target="bed", method="toponav", seed=3, stop_called=True,
    distance_to_goal=0.05, shortest_path=4.0, path_length=5.0,
    success={"0.1": True, "0.2": True, "0.25": True, "1.0": True},
    spl=0.8, soft_spl=0.79, steps=30, collisions=1, decisions=2,
    seconds={"total": 1.5}, ended="stop", floor_change=False, config_sha="0" * 12,
)  # fmt: skip
NEAR = replace(
    FOUND, index=1, distance_to_goal=0.15, spl=0.0, soft_spl=0.5, steps=50,
    success={"0.1": False, "0.2": True, "0.25": True, "1.0": True},
)  # fmt: skip
LOST = replace(
    FOUND, index=2, distance_to_goal=math.inf, spl=0.0, soft_spl=0.0, steps=10,
    success=dict.fromkeys(FOUND.success, False), ended="error: lost",
)  # fmt: skip

metres = st.one_of(st.floats(0.0, 100.0), st.just(math.inf))


def test_a_score_worked_by_hand() -> None:
    score = score_episode(True, 0.15, 4.0, 5.0)
    assert score.success == {"0.1": False, "0.2": True, "0.25": True, "1.0": True}
    assert score.spl == 0.0
    assert score.soft_spl == pytest.approx((1 - 0.15 / 4.0) * 4.0 / 5.0)
    assert score_episode(True, 0.05, 4.0, 5.0).spl == pytest.approx(0.8)
    assert not any(score_episode(False, 0.05, 4.0, 5.0).success.values())


@given(stop=st.booleans(), dtg=metres, shortest=metres, path=st.floats(0.0, 100.0))
def test_scores_are_rates_and_a_wider_radius_never_fails_first(
    stop: bool, dtg: float, shortest: float, path: float
) -> None:
    score = score_episode(stop, dtg, shortest, path)
    assert 0.0 <= score.spl <= 1.0
    assert 0.0 <= score.soft_spl <= 1.0
    by_radius = [score.success[key] for key in sorted(score.success, key=float)]
    assert by_radius == sorted(by_radius)
    assert score.spl == 0.0 or score.success["0.1"]


def test_a_line_holds_the_whole_record() -> None:
    line = to_json(FOUND)
    assert "\n" not in line
    assert json.loads(line) == json_ready(asdict(FOUND))
    assert json.loads(line)["vlm"] == {
        "calls": 0, "failures": 0, "prompt_tokens": 0, "completion_tokens": 0, "cost_usd": 0.0,
        "failure_kinds": {}, "unanswered": 0, "not_recorded": 0, "cached": 0,
    }  # fmt: skip


def test_json_has_no_infinity() -> None:
    assert json.loads(to_json(LOST))["distance_to_goal"] is None
    assert json_ready({1: [math.inf, (math.nan, 2.0)], "x": {"y": -math.inf}}) == {
        "1": [None, [None, 2.0]],
        "x": {"y": None},
    }


def test_the_summary_of_three_episodes() -> None:
    summary = summarize([FOUND, NEAR, LOST])
    assert summary["n"] == 3
    assert summary["sr"]["0.1"]["rate"] == pytest.approx(1 / 3)
    assert summary["sr"]["0.2"]["rate"] == pytest.approx(2 / 3)
    assert summary["spl"] == pytest.approx(0.8 / 3)
    assert summary["soft_spl"] == pytest.approx((0.79 + 0.5) / 3)
    assert summary["dtg"] == pytest.approx(0.1)  # without the unreachable one, which is counted
    assert summary["unreachable"] == 1
    assert summary["steps"] == pytest.approx(30.0)
    low, high = summary["sr"]["0.1"]["interval"]
    assert low == pytest.approx(0.0615, abs=1e-4)  # Wilson's interval of 1 in 3
    assert high == pytest.approx(0.7923, abs=1e-4)


def test_the_summary_of_nothing_claims_nothing() -> None:
    summary = summarize([])
    assert summary["n"] == 0
    assert summary["spl"] is None
    assert summary["sr"]["0.1"] == {"rate": None, "interval": [0.0, 1.0]}
    json.dumps(summary, allow_nan=False)


def test_success_is_the_benchmark_radius() -> None:
    assert FOUND.succeeded
    assert not NEAR.succeeded
