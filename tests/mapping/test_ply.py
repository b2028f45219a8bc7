"""PLY files, read back by trimesh."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from toponav.mapping.ply import write_ply
from toponav.mapping.view import PointCloud


def random_cloud(count: int) -> PointCloud:
    rng = np.random.default_rng(count)
    return PointCloud(
        rng.normal(size=(count, 3)).astype(np.float32),
        rng.integers(0, 256, (count, 3), dtype=np.uint8),
        rng.integers(1, 99, count, dtype=np.int32),
    )


def test_points_and_colors_survive(tmp_path: Path) -> None:
    cloud = random_cloud(57)
    write_ply(tmp_path / "deep" / "cloud.ply", cloud)
    loaded = trimesh.load(tmp_path / "deep" / "cloud.ply")
    np.testing.assert_array_equal(loaded.vertices.astype(np.float32), cloud.points)
    np.testing.assert_array_equal(loaded.colors[:, :3], cloud.colors)


def test_counts_are_stored_after_the_colors(tmp_path: Path) -> None:
    cloud = random_cloud(5)
    write_ply(tmp_path / "cloud.ply", cloud)
    header, body = (tmp_path / "cloud.ply").read_bytes().split(b"end_header\n")
    assert b"element vertex 5" in header
    counts = np.frombuffer(body, np.dtype([("rest", "V15"), ("count", "<i4")]))["count"]
    np.testing.assert_array_equal(counts, cloud.counts)


def test_an_empty_cloud_is_a_valid_file(tmp_path: Path) -> None:
    write_ply(tmp_path / "cloud.ply", random_cloud(0))
    assert b"element vertex 0" in (tmp_path / "cloud.ply").read_bytes()


def test_an_older_file_is_replaced_whole_and_nothing_else_is_left(tmp_path: Path) -> None:
    path = tmp_path / "cloud.ply"
    write_ply(path, random_cloud(100))
    write_ply(path, random_cloud(3))
    assert len(trimesh.load(path).vertices) == 3
    assert [file.name for file in tmp_path.iterdir()] == ["cloud.ply"]


def test_a_file_that_cannot_be_written_is_an_os_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        write_ply(tmp_path / "file" / "cloud.ply", random_cloud(1))
