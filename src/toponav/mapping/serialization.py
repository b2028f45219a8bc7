"""A map as plain arrays and back: all that later frames build on, and nothing that follows from it.

The arrays' names are paths: `scene/keys`, `objects/<category>/counts`, `floors/0/bridges/keys`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.errors import InputError
from toponav.mapping.floors import Floor
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.voxels import KEPT, VoxelCloud

Arrays = dict[str, NDArray[Any]]


def map_arrays(semantic_map: SemanticMap) -> Arrays:
    """Everything that `map_of` needs."""
    parts = semantic_map.parts()
    arrays = _cloud_arrays("scene", parts.scene)
    arrays["resolution"] = np.array([parts.scene.resolution])
    arrays["categories"] = np.array(list(parts.objects), dtype=np.str_)
    for label, cloud in parts.objects.items():
        arrays |= _cloud_arrays(f"objects/{label}", cloud)
    arrays["floors"] = np.array([floor.z for floor in parts.floors])
    for floor in parts.floors:
        name = f"floors/{floor.index}"
        arrays |= _cloud_arrays(f"{name}/bridges", floor.bridges)
        arrays |= _cloud_arrays(f"{name}/treads", floor.treads)
        columns, counts = floor.grid.seen_through()
        arrays[f"{name}/through/columns"], arrays[f"{name}/through/counts"] = columns, counts
    return arrays


def map_of(arrays: Mapping[str, NDArray[Any]], config: MapConfig) -> SemanticMap:
    """The map that made some arrays; the agent is on none of its floors yet.

    Raises:
        InputError: An array is missing or of another shape, or the map is of another resolution.
    """
    try:
        resolution = float(arrays["resolution"][0])
        if abs(resolution - config.r_pcd) > 1e-9:
            raise InputError(
                f"the map has voxels of {resolution} m and the configuration of {config.r_pcd} m: "
                f"set navigator.map.r_pcd={resolution}"
            )
        semantic_map = SemanticMap(config)
        semantic_map.restore_scene(_cloud(arrays, "scene", resolution))
        for label in arrays["categories"].tolist():
            cloud = _cloud(arrays, f"objects/{label}", resolution)
            semantic_map.restore_object(label, cloud)
        for index, z in enumerate(arrays["floors"].tolist()):
            _restore_floor(semantic_map, semantic_map.restore_floor(z), f"floors/{index}", arrays)
    except (KeyError, ValueError, IndexError, TypeError) as error:
        raise InputError(f"the map is broken: {error}") from error
    return semantic_map


def _restore_floor(
    semantic_map: SemanticMap, floor: Floor, name: str, arrays: Mapping[str, NDArray[Any]]
) -> None:
    resolution = semantic_map.config.r_pcd
    for part in ("bridges", "treads"):
        points = _cloud(arrays, f"{name}/{part}", resolution).cloud().points
        getattr(floor, part).add(points.astype(np.float64))
        getattr(floor, part).refresh()
    bridged = floor.bridges.cloud().points
    floor.grid.bridge(np.floor(bridged[:, :2] / resolution).astype(np.int64))
    through = arrays[f"{name}/through/columns"], arrays[f"{name}/through/counts"]
    floor.grid.restore_seen_through(*through)


def _cloud_arrays(name: str, cloud: VoxelCloud) -> Arrays:
    kept = np.flatnonzero(cloud.arrays.counts[: len(cloud)])
    return {f"{name}/{part}": getattr(cloud.arrays, part)[kept] for part in KEPT}


def _cloud(arrays: Mapping[str, NDArray[Any]], name: str, resolution: float) -> VoxelCloud:
    return VoxelCloud.from_arrays(resolution, [arrays[f"{name}/{part}"] for part in KEPT])
