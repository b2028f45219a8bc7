"""The published benchmarks by name: their files, and what is said when one is missing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from episode_files import content, write

from published_scenes import write_hm3d
from shared_data import shared_data
from small_house import small_scene
from toponav.datasets.benchmarks import BENCHMARKS, benchmark_file, is_benchmark
from toponav.errors import InputError, SceneError
from toponav.evaluation.sources import open_source


@pytest.mark.parametrize("name", BENCHMARKS)
def test_a_missing_episode_file_is_named_with_its_place_and_archive(
    name: str, tmp_path: Path
) -> None:
    assert is_benchmark(name)
    folder = tmp_path / "datasets" / "objectnav" / BENCHMARKS[name].folder
    expected = folder / "val" / "val.json.gz"
    with pytest.raises(InputError, match=re.escape(str(expected))) as caught:
        open_source(name, None, tmp_path)
    assert BENCHMARKS[name].archive in str(caught.value)
    assert "\n" not in str(caught.value)


def test_another_split_is_named_after_a_colon(tmp_path: Path) -> None:
    path = tmp_path / "datasets" / "objectnav" / "hm3d" / "v2" / "mini" / "mini.json.gz"
    write(path, content())
    assert benchmark_file("objectnav-hm3d-v2:mini", tmp_path) == path


@pytest.mark.parametrize(
    ("file", "scene", "source"),
    [
        ("hm3d/v1/val_mini/val_mini.json.gz", "hm3d/", "matterport.com"),
        ("hm3d/v2/val_mini/val_mini.json.gz", "hm3d_v0.2/", "matterport.com"),
        ("mp3d/v1/val_mini/val_mini.json.gz", "mp3d/", "niessner.github.io"),
    ],
)
def test_published_episodes_name_the_scene_that_is_missing(
    file: str, scene: str, source: str, tmp_path: Path
) -> None:
    episodes = open_source(str(shared_data("objectnav") / file), None, tmp_path)
    with pytest.raises(SceneError, match=re.escape(str(tmp_path / "scene_datasets" / scene))) as e:
        episodes.outlines()
    assert source in str(e.value)


def test_published_episodes_find_a_scene_in_the_published_format(tmp_path: Path) -> None:
    """One scene of val_mini stands where it is expected; the other is then the missing one."""
    path = shared_data("objectnav") / "hm3d/v2/val_mini/content/TEEsavR23oF.json.gz"
    source = open_source(str(path), None, tmp_path)
    folder = tmp_path / "scene_datasets/hm3d_v0.2/minival/00800-TEEsavR23oF"
    write_hm3d(folder / "TEEsavR23oF.basis.glb", small_scene())
    [outline] = source.outlines()
    scene = source.load(outline.spec)
    assert (scene.name, len(scene.episodes)) == ("TEEsavR23oF", outline.episodes)
    assert outline.episodes > 0
    assert {"bed", "chair"} & {instance.category for instance in scene.mesh.instances}
