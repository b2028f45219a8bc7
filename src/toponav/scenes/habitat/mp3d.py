"""MP3D scenes: `X.glb` with `X.house` and `X_semantic.ply` beside it.

Each triangle of the PLY file has an `object_id`, which is the number of an object in the `.house`
file; both are z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.errors import SceneError
from toponav.scenes.habitat.annotated_mesh import annotated_scene, load_stage
from toponav.scenes.habitat.semantic_transfer import spread_points, transfer_labels
from toponav.scenes.house_io import read_text
from toponav.scenes.mesh import Scene
from toponav.types import Instance

HOUSE, SEMANTIC_MESH = ".house", "_semantic.ply"

HEADER = "ASCII 1.1"

VAGUE = frozenset({"void", "unlabeled", "misc", "objects", "furniture", "appliances", "lighting"})
"""Of these classes the annotators' own word says more."""

_OBJECT_ID = ("object_id", "objectId")


@dataclass(frozen=True)
class HouseFile:
    """What a `.house` file says of objects.

    Attributes:
        categories: Canonical category by object number.
    """

    categories: dict[int, str]


def is_mp3d_stage(path: Path) -> bool:
    """Whether a `.glb` is a stage with MP3D's annotations beside it."""
    return path.suffix.lower() == ".glb" and path.with_suffix(HOUSE).is_file()


def load_mp3d_scene(stage: Path) -> Scene:
    """Load a stage and its annotations.

    Raises:
        SceneError: One line: a file is missing or damaged.
    """
    house, labelled_file = stage.with_suffix(HOUSE), stage.with_name(stage.stem + SEMANTIC_MESH)
    for path in (stage, house, labelled_file):
        if not path.is_file():
            raise SceneError(
                f"{path}: no such file; MP3D's annotations lie beside {stage.name}, and "
                "download_mp.py with --task habitat brings them"
            )
    categories = read_house_file(house).categories
    corners, labels = _read_semantic_ply(labelled_file)
    points = spread_points(corners)
    mesh = load_stage(stage)
    owner = transfer_labels(mesh.vertices[mesh.faces], corners, points, labels[points.face])
    owner[~np.isin(owner, list(categories))] = -1
    instances = {k: Instance(k, f"{name}_{k}", name) for k, name in categories.items()}
    return annotated_scene(stage, mesh, owner, instances)


def read_house_file(path: Path) -> HouseFile:
    """Read the categories (C) and objects (O) of a house; other lines say nothing of objects.

    Raises:
        SceneError: One line with file and line number.
    """
    lines = read_text(path).splitlines()
    if not lines or lines[0].strip() != HEADER:
        raise SceneError(f"{path}: does not begin with {HEADER!r}; fetch the house file again")
    names: dict[int, str] = {}
    owners: dict[int, int] = {}
    for number, line in enumerate(lines[1:], start=2):
        words = line.split()
        try:
            if words[:1] == ["C"]:
                names[int(words[1])] = _category(words[3].replace("#", " "), words[5])
            elif words[:1] == ["O"]:
                owners[int(words[1])] = int(words[3])
        except (IndexError, ValueError) as error:
            raise SceneError(f"{path}: line {number}: not a category or an object") from error
    unknown = next((k for k, category in owners.items() if category >= 0 and category not in names),
                   None)  # fmt: skip
    if unknown is not None:
        raise SceneError(f"{path}: object {unknown} is of a category that the file does not name")
    return HouseFile({k: names.get(category, "unknown") for k, category in owners.items()})


def _category(raw: str, mpcat40: str) -> str:
    """The canonical category of MP3D's class and the annotators' own word."""
    name = canonical(raw) if mpcat40 in VAGUE else canonical(mpcat40)
    return "unknown" if name in VAGUE else name


def _read_semantic_ply(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(F, 3, 3) triangles and (F,) object ids.

    Raises:
        SceneError: The file is damaged or has no object ids.
    """
    try:
        mesh: Any = trimesh.load_mesh(path, process=False)
        raw = mesh.metadata["_ply_raw"]["face"]["data"]
        name = next((name for name in _OBJECT_ID if name in raw.dtype.names), None)
        corners = np.asarray(mesh.vertices, np.float64)[mesh.faces]
    except Exception as error:
        # The readers of damaged files fail in as many ways as files can be damaged.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(f"{path}: damaged or incomplete: {reason}") from error
    if name is None:
        raise SceneError(f"{path}: its faces have no object_id; fetch the file again")
    labels = np.asarray(raw[name], np.int64).reshape(-1)
    if len(labels) != len(corners):
        raise SceneError(f"{path}: {len(labels)} object ids for {len(corners)} triangles")
    return corners, labels
