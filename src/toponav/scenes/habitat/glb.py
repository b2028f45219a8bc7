"""Binary glTF of bare triangles with vertex colours: a semantic mesh and nothing else."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.scenes.glb_container import glb_bytes

_FLOAT, _UNSIGNED_BYTE, _UNSIGNED_INT = 5126, 5121, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963


def colored_triangles_glb(corners: NDArray[np.float64], colors: NDArray[np.uint8]) -> bytes:
    """One mesh of triangles that share no vertex.

    Args:
        corners: (F, 3, 3) in the file's axes (y up), metres.
        colors: (F, 3) linear colours, one a triangle.
    """
    positions = corners.reshape(-1, 3).astype("<f4")
    rgba = np.full((len(positions), 4), 255, np.uint8)
    rgba[:, :3] = np.repeat(colors, 3, axis=0)
    indices = np.arange(len(positions), dtype="<u4")
    blocks = [positions.tobytes(), rgba.tobytes(), indices.tobytes()]
    starts = np.cumsum([0, *map(len, blocks)]).tolist()
    targets = (_ARRAY_BUFFER, _ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER)
    low, high = positions.min(axis=0), positions.max(axis=0)
    count = len(positions)
    description = {
        "asset": {"version": "2.0", "generator": "toponav"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "semantic"}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0}}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}
                ]
            }
        ],
        "accessors": [
            _accessor(0, _FLOAT, count, "VEC3") | {"min": low.tolist(), "max": high.tolist()},
            _accessor(1, _UNSIGNED_BYTE, count, "VEC4") | {"normalized": True},
            _accessor(2, _UNSIGNED_INT, count, "SCALAR"),
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(block), "target": target}
            for start, block, target in zip(starts[:-1], blocks, targets, strict=True)
        ],
        "buffers": [{"byteLength": starts[-1]}],
    }
    return glb_bytes(description, b"".join(blocks))


def _accessor(view: int, component: int, count: int, kind: str) -> dict[str, Any]:
    return {"bufferView": view, "componentType": component, "count": count, "type": kind}
