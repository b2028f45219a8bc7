"""The published ObjectNav benchmarks by name, and where their episode files are expected."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from toponav.errors import InputError

EPISODES_FOLDER = Path("datasets", "objectnav")
"""Where Habitat's users keep ObjectNav episodes, within their data folder."""

DEFAULT_SPLIT = "val"


@dataclass(frozen=True)
class Benchmark:
    """One benchmark's episodes.

    Attributes:
        folder: Below `EPISODES_FOLDER`.
        archive: What its publishers offer; holds the folders of the splits.
    """

    folder: str
    archive: str


_BASE = "https://dl.fbaipublicfiles.com/habitat/data/datasets/objectnav"

BENCHMARKS = {
    "objectnav-hm3d-v1": Benchmark("hm3d/v1", f"{_BASE}/hm3d/v1/objectnav_hm3d_v1.zip"),
    "objectnav-hm3d-v2": Benchmark("hm3d/v2", f"{_BASE}/hm3d/v2/objectnav_hm3d_v2.zip"),
    "objectnav-mp3d": Benchmark("mp3d/v1", f"{_BASE}/m3d/v1/objectnav_mp3d_v1.zip"),
}
"""By the name that stands for it as a SOURCE; `name:split` takes another split than `val`."""


def is_benchmark(source: str) -> bool:
    """Whether a SOURCE names a benchmark."""
    return source.partition(":")[0] in BENCHMARKS


def benchmark_file(source: str, data: Path) -> Path:
    """The episode file of a benchmark.

    Args:
        source: A benchmark's name, with `:split` or without.
        data: Habitat's data folder.

    Raises:
        InputError: The file is missing; one line says where it is expected and who has it.
    """
    name, _, split = source.partition(":")
    split = split or DEFAULT_SPLIT
    benchmark = BENCHMARKS[name]
    folder = data / EPISODES_FOLDER / benchmark.folder
    path = folder / split / f"{split}.json.gz"
    if not path.is_file():
        raise InputError(
            f"{path}: no such episode file; unpack {benchmark.archive} so that {folder} holds the "
            f"folder {split!r} (--data names the folder that holds {EPISODES_FOLDER})"
        )
    return path
