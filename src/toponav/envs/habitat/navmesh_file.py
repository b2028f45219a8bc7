"""A navigable surface as the `.navmesh` file that Habitat loads: Detour's tile, in its binary form.

One tile, no links outside it, no bounding-volume tree (Detour then looks at every polygon). The
file says for which body it was made; Habitat computes a navmesh of its own for any other.
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator.agent_body import AgentBody
from toponav.envs.simulator.convex_mesh import MAX_CORNERS, ConvexMesh
from toponav.errors import SceneError
from toponav.geometry.conventions import HABITAT_FROM_WORLD

_SET_MAGIC, _SET_VERSION = int.from_bytes(b"MSET", "big"), 2
_TILE_MAGIC, _TILE_VERSION = int.from_bytes(b"DNAV", "big"), 7

_SET_HEADER = struct.Struct("<3i5f2i")
"""Magic, version, tiles; then origin (3), tile width and length, most tiles, most polygons."""

_SETTINGS = struct.Struct("<13f4?")
"""Habitat's NavMeshSettings."""

_TILE_REFERENCE = struct.Struct("<Ii")
_TILE_HEADER = struct.Struct("<5iI9i10f")
_POLYGON = struct.Struct("<I6H6HHBB")
_DETAIL = struct.Struct("<IIBBxx")
_LINK_BYTES = 12

MAX_VERTICES = 0xFFFF
"""Indices have 16 bits."""

CELL_HEIGHT_M = 0.2
REGION_CELLS, EDGE_CELLS, EDGE_ERROR_CELLS = 20.0, 12.0, 1.3
DETAIL_SAMPLE_CELLS, DETAIL_ERROR_CELLS = 6.0, 1.0
"""Habitat's defaults: not used here, but what it compares before it takes the file."""

_WALKABLE = 1
_NO_LINK = 0xFFFFFFFF


def navmesh_bytes(mesh: ConvexMesh, body: AgentBody) -> bytes:
    """The file's content.

    Raises:
        SceneError: The surface is empty, or too ragged for Detour's 16-bit indices.
    """
    if not mesh.polygons or len(mesh.vertices) > MAX_VERTICES:
        raise SceneError(
            f"a navmesh holds 1 to {MAX_VERTICES} corners, not {len(mesh.vertices)}: use a larger "
            "cell_size"
        )
    vertices = HABITAT_FROM_WORLD.apply(mesh.vertices).astype("<f4")
    tile = _tile(vertices, mesh, body)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    count = len(mesh.polygons)
    header = _SET_HEADER.pack(
        _SET_MAGIC, _SET_VERSION, 1, *low.tolist(), high[0] - low[0], high[2] - low[2], 1, count
    )
    reference = 1 << (count - 1).bit_length()  # the first generation of tile 0
    return header + _settings(body) + _TILE_REFERENCE.pack(reference, len(tile)) + tile


def _settings(body: AgentBody) -> bytes:
    return _SETTINGS.pack(
        body.cell_size, CELL_HEIGHT_M, body.height, body.radius, body.max_climb,
        body.max_slope_deg, REGION_CELLS, REGION_CELLS, EDGE_CELLS, EDGE_ERROR_CELLS,
        float(MAX_CORNERS), DETAIL_SAMPLE_CELLS, DETAIL_ERROR_CELLS, True, True, True, False,
    )  # fmt: skip


def _tile(vertices: NDArray[np.float32], mesh: ConvexMesh, body: AgentBody) -> bytes:
    polygons: list[bytes] = []
    details: list[bytes] = []
    triangles: list[bytes] = []
    for shape, across in zip(mesh.polygons, mesh.neighbours, strict=True):
        beyond = [k + 1 for k in across]  # 0 is a wall
        spare = [0] * (MAX_CORNERS - len(shape))
        polygons.append(
            _POLYGON.pack(_NO_LINK, *shape, *spare, *beyond, *spare, _WALKABLE, len(shape), 0)
        )
        details.append(_DETAIL.pack(0, len(triangles), 0, len(shape) - 2))
        triangles += _fan(len(shape))
    corners_in_all = sum(map(len, mesh.polygons))
    header = _TILE_HEADER.pack(
        _TILE_MAGIC, _TILE_VERSION, 0, 0, 0, 0,
        len(polygons), len(vertices), corners_in_all, len(details), 0, len(triangles), 0, 0,
        len(polygons),
        body.height, body.radius, body.max_climb,
        *vertices.min(axis=0).tolist(), *vertices.max(axis=0).tolist(), 1.0 / body.cell_size,
    )  # fmt: skip
    links = bytes(_LINK_BYTES * corners_in_all)  # filled in when the tile is added
    return b"".join([header, vertices.tobytes(), *polygons, links, *details, *triangles])


def _fan(corners: int) -> list[bytes]:
    """The triangles of a convex polygon with the flags of their sides on its border."""
    return [
        bytes([0, k - 1, k, (1 << 2) | (k == 2) | ((k == corners - 1) << 4)])
        for k in range(2, corners)
    ]
