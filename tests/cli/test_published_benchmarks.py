"""The benchmarks by name, on scenes in the published formats in Habitat's folder tree."""

from __future__ import annotations

import gzip
import importlib.util
import json
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import pytest

from published_scenes import write_hm3d, write_mp3d
from small_house import SMALL, small_scene
from toponav.cli.main import main
from toponav.evaluation.objectnav_export import DatasetPlan, export_dataset

QUICK = ("--method", "random", "--max-steps", "5", "--no-record", *SMALL)

HM3D_CONFIG = {
    "stages": {
        "default_attributes": {
            "shader_type": "flat",
            "up": [0, 0, 1],
            "front": [0, 1, 0],
            "origin": [0, 0, 0],
            "semantic_up": [0, 0, 1],
            "semantic_front": [0, 1, 0],
            "semantic_descriptor_filename": "%%CONFIG_NAME_AS_ASSET_FILENAME%%.semantic.txt",
            "semantic_asset": "%%CONFIG_NAME_AS_ASSET_FILENAME%%.semantic.glb",
        },
        "paths": {".glb": ["val/0080*/*.basis.glb"]},
    }
}


@dataclass(frozen=True)
class Published:
    """A benchmark, and where its files belong in the data folder."""

    name: str
    scene_id: str
    episodes: str


BENCHMARKS = [
    Published("objectnav-hm3d-v1", "hm3d/val/00800-TEEsavR23oF/TEEsavR23oF.basis.glb", "hm3d/v1"),
    Published(
        "objectnav-hm3d-v2", "hm3d_v0.2/val/00800-TEEsavR23oF/TEEsavR23oF.basis.glb", "hm3d/v2"
    ),
    Published("objectnav-mp3d", "mp3d/x8F5xyUWy9e/x8F5xyUWy9e.glb", "mp3d/v1"),
]


def write_scene(benchmark: Published, data: Path) -> Path:
    """The small house as one of the benchmark's scenes."""
    stage = data / "scene_datasets" / benchmark.scene_id
    if benchmark.name == "objectnav-mp3d":
        return write_mp3d(stage, small_scene())
    config = stage.parents[2] / "hm3d_annotated_basis.scene_dataset_config.json"
    write_hm3d(stage, small_scene(), textured=benchmark.name.endswith("v2"))
    config.write_text(json.dumps(HM3D_CONFIG))
    return stage


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Two episodes of the small house in the published format, under its own name."""
    plan = DatasetPlan(tmp_path_factory.mktemp("drawn") / "data", episodes=2)
    files = export_dataset([small_scene()], plan)
    content = next(path for path in files if path.parent.name == "content")
    return gzip.decompress(content.read_bytes()).decode()


def write_episodes(benchmark: Published, data: Path, drawn: str) -> None:
    """The episodes, as those of the benchmark's scene."""
    ours = small_scene().name
    published = PurePosixPath(benchmark.scene_id).name
    text = drawn.replace(f"toponav/{ours}/{ours}.glb", benchmark.scene_id)
    text = text.replace(f"{ours}.glb_", f"{published}_")
    split = data / "datasets" / "objectnav" / benchmark.episodes / "val"
    split.mkdir(parents=True)
    (split / "val.json.gz").write_bytes(gzip.compress(text.encode()))


@pytest.mark.parametrize("backend", ["embedded", "habitat"])
@pytest.mark.parametrize("benchmark", BENCHMARKS, ids=lambda benchmark: benchmark.name)
def test_a_benchmark_runs_by_its_name(
    benchmark: Published, backend: str, drawn: str, tmp_path: Path
) -> None:
    if backend == "habitat" and importlib.util.find_spec("habitat_sim") is None:
        pytest.skip("habitat-sim is not installed (docs/habitat.md)")
    data = tmp_path / "data"
    write_scene(benchmark, data)
    write_episodes(benchmark, data, drawn)
    where = ("--data", str(data), "--backend", backend, "--out", str(tmp_path / "out"))
    assert main(["eval", benchmark.name, *QUICK, *where]) == 0
    records = (tmp_path / "out" / "episodes.jsonl").read_text().splitlines()
    scenes = {json.loads(record)["scene"] for record in records}
    assert scenes == {PurePosixPath(benchmark.scene_id).name.split(".")[0]}
    assert len(records) == 2
    assert all(json.loads(record)["shortest_path"] < 100.0 for record in records)


@pytest.mark.parametrize("benchmark", BENCHMARKS, ids=lambda benchmark: benchmark.name)
def test_what_a_benchmark_lacks_is_named_in_turn(
    benchmark: Published, drawn: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = tmp_path / "data"
    run = ["eval", benchmark.name, *QUICK, "--data", str(data), "--out", str(tmp_path / "out")]
    assert main(run) == 2
    error = capsys.readouterr().err
    assert str(data / "datasets" / "objectnav" / benchmark.episodes / "val") in error
    assert ".zip" in error
    write_episodes(benchmark, data, drawn)
    assert main(run) == 2
    error = capsys.readouterr().err
    assert str(data / "scene_datasets" / benchmark.scene_id) in error
    assert "licensed" in error
    stage = write_scene(benchmark, data)
    for labels in set(stage.parent.iterdir()) - {stage}:
        held = labels.rename(labels.with_suffix(".held"))
        assert main(run) == 2
        error = capsys.readouterr().err
        assert f"{labels}: no such file" in error
        assert "licensed" in error
        held.rename(labels)
    assert not (tmp_path / "out").exists()
    assert main(run) == 0
