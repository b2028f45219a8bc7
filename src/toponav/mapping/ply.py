"""Point clouds as binary PLY, which CloudCompare, MeshLab, Open3D and trimesh read."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from toponav.files import write_atomic
from toponav.mapping.view import PointCloud

VERTEX = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("red", "u1"),
        ("green", "u1"),
        ("blue", "u1"),
        ("count", "<i4"),
    ]
)
"""One vertex: position in metres, colour, and `count`, the number of points averaged."""

PLY_TYPES = {"<f4": "float", "|u1": "uchar", "<i4": "int"}
"""NumPy's name of a type to PLY's."""


def write_ply(path: Path, cloud: PointCloud) -> None:
    """Replace a file by a cloud in binary little-endian PLY.

    Raises:
        OSError: The file cannot be written; an older one is left as it was.
    """
    vertices = np.empty(len(cloud), VERTEX)
    vertices["x"], vertices["y"], vertices["z"] = cloud.points.T
    vertices["red"], vertices["green"], vertices["blue"] = cloud.colors.T
    vertices["count"] = cloud.counts
    properties = [f"property {PLY_TYPES[VERTEX[name].str]} {name}" for name in VERTEX.names or ()]
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment world frame, z up, metres",
        f"element vertex {len(cloud)}",
        *properties,
        "end_header",
    ]
    write_atomic(path, ("\n".join(header) + "\n").encode("ascii") + vertices.tobytes())
