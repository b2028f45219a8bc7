"""Episodes of published benchmarks, read from their own files."""

from toponav.datasets.benchmarks import benchmark_file, is_benchmark
from toponav.datasets.check import DatasetReport, check_objectnav
from toponav.datasets.objectnav import (
    Goal,
    ObjectNavDataset,
    ObjectNavEpisode,
    load_objectnav,
    save_objectnav,
)
from toponav.datasets.objectnav_file import is_objectnav_file
from toponav.datasets.scene_files import missing_file, scene_file

__all__ = [
    "DatasetReport",
    "Goal",
    "ObjectNavDataset",
    "ObjectNavEpisode",
    "benchmark_file",
    "check_objectnav",
    "is_benchmark",
    "is_objectnav_file",
    "load_objectnav",
    "missing_file",
    "save_objectnav",
    "scene_file",
]
