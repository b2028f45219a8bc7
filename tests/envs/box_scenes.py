"""Hand-made scenes of boxes for the simulator's tests."""

from __future__ import annotations

import numpy as np

from toponav.scenes.mesh import Material, SceneMesh
from toponav.types import Instance

WHITE = Material("white", np.full((1, 1, 3), 255, np.uint8))
BOX_FACES = np.array(
    [
        (0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4),
        (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7),
    ],
    np.int32,
)  # fmt: skip

Box = tuple[tuple[float, float, float], tuple[float, float, float]]


def mesh_of(vertices, faces, instance=None, categories=("thing",)) -> SceneMesh:
    """A white mesh; `instance` is (F,) ids into `categories`."""
    faces = np.asarray(faces, np.int32)
    ids = np.zeros(len(faces), np.int32) if instance is None else np.asarray(instance, np.int32)
    return SceneMesh(
        vertices=np.asarray(vertices, float),
        faces=faces,
        face_uv=np.zeros((len(faces), 3, 2), np.float32),
        face_material=np.zeros(len(faces), np.int32),
        face_instance=ids,
        materials=(WHITE,),
        instances=tuple(Instance(k, f"{c}_{k}", c) for k, c in enumerate(categories)),
    )


def boxes(parts: list[tuple[str, Box]]) -> SceneMesh:
    """Axis-aligned boxes, each an instance of its category."""
    vertices, faces, ids = [], [], []
    for k, (_, ((x0, y0, z0), (x1, y1, z1))) in enumerate(parts):
        corners = [
            (x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
            (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1),
        ]  # fmt: skip
        faces.append(BOX_FACES + 8 * k)
        vertices += corners
        ids += [k] * 12
    return mesh_of(vertices, np.concatenate(faces), ids, [category for category, _ in parts])


def room(size=(6.0, 4.0, 2.5), wall=0.1, extra=()) -> SceneMesh:
    """A closed room from the origin to `size`, floor top at z = 0, with extra boxes in it."""
    x, y, z = size
    parts = [
        ("floor", ((-wall, -wall, -wall), (x + wall, y + wall, 0.0))),
        ("ceiling", ((-wall, -wall, z), (x + wall, y + wall, z + wall))),
        ("wall", ((-wall, -wall, 0.0), (0.0, y + wall, z))),
        ("wall", ((x, -wall, 0.0), (x + wall, y + wall, z))),
        ("wall", ((0.0, -wall, 0.0), (x, 0.0, z))),
        ("wall", ((0.0, y, 0.0), (x, y + wall, z))),
    ]
    return boxes([*parts, *extra])
