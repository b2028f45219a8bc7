"""The benchmarks of the map: what it costs, what it holds, and what of it is stale."""

from __future__ import annotations

import json

import pytest

from toponav.cli.main import main


def figures(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, object]:
    assert main(["bench", *arguments, "--camera", "80x60", "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_map_holds_the_voxels_of_all_points(capsys: pytest.CaptureFixture[str]) -> None:
    found = figures(capsys, "map", "--area", "40")
    assert found["equal_to_reference"] is True
    assert found["voxels"] > 1000
    assert found["frames"] == 36
    assert found["open3d_ratio"] is None


def test_a_decision_is_timed_in_both_buildings(capsys: pytest.CaptureFixture[str]) -> None:
    found = figures(capsys, "decide", "--small", "40", "--large", "100", "--decisions", "2")
    assert found["decide_growth"] == found["decide_large_ms"] / found["decide_ms"]
    assert found["decide_ms"] > 0.0


def test_standing_still_adds_no_voxel(capsys: pytest.CaptureFixture[str]) -> None:
    found = figures(capsys, "memory", "--area", "40", "--still", "24")
    assert found["mapped_m2"] > 20.0
    assert found["map_bytes_per_m2"] * found["area_m2"] == pytest.approx(1e6 * found["map_mb"])


def test_open3d_is_asked_for_by_name_where_it_is_absent(
    capsys: pytest.CaptureFixture[str],
) -> None:
    try:
        import open3d  # noqa: F401
    except (ImportError, OSError):
        pass
    else:
        pytest.skip("Open3D is installed")
    assert main(["bench", "map", "--area", "40", "--camera", "80x60", "--open3d"]) == 2
    assert "pip install open3d" in capsys.readouterr().err


def test_moved_things_are_counted_with_and_without_clearing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = figures(capsys, "moved", "--houses", "1")
    for name in ("clearing", "keeping"):
        one = found[name]
        assert one["episodes"] == 1
        assert one["seen_again"] > 0
        assert one["stale_share"] == one["stale"] / one["seen_again"]
    assert found["keeping"]["stale_share"] == 1.0
    assert found["clearing"]["stale_share"] < 0.5
