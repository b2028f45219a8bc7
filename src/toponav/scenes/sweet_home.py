"""Furniture catalogues of Sweet Home 3D (`.sh3f`): textured models of real pieces of furniture.

A catalogue is a zip archive of OBJ models and a properties file that gives each its name, its size
in centimetres and the rotation that brings it upright. Rotated, a model is y up and its front faces
+z, which is also how glTF has it.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.errors import SceneError
from toponav.scenes.furniture.shape import Size
from toponav.scenes.furniture_sizes import SIZE_RANGES

PROPERTIES = "PluginFurnitureCatalog.properties"
"""The archive's table of contents; its translations have a language in their names."""

MAX_TRIANGLES = 20_000
"""Pieces with more are passed over: a house has dozens, and each is drawn in every frame."""

MAX_TEXTURE_PX = 512
"""Longer side of a texture as it is written."""

PIECE_NAMES = {
    "baignoire": "bathtub",
    "bike": "bicycle",
    "captain's bed": "bed",
    "couch": "sofa",
    "clothes washing machine": "washing_machine",
    "decorative plant": "plant",
    "drawers cabinet": "chest_of_drawers",
    "dresser with drawers": "chest_of_drawers",
    "dryer machine": "dryer",
    "dustbin": "refuse_bin",
    "ficus": "plant",
    "full bookcase": "bookshelf",
    "futon couch": "sofa",
    "iron bed": "bed",
    "indoor plant": "plant",
    "modern armchair": "chair",
    "oak chair": "chair",
    "oak table": "table",
    "residential trashcan": "refuse_bin",
    "sofa 2 seats": "sofa",
    "sofa 3 seats": "sofa",
    "spathiphyllum": "plant",
    "television cabinet": "tv_stand",
    "toilets unit": "toilet",
    "treadmill": "gym_equipment",
    "tv 16:9": "tv_monitor",
    "upright piano": "piano",
    "wall flat tv": "tv_monitor",
    "winchester sofa": "sofa",
    "wooden desk": "desk",
    "wooden table": "table",
    "yucca": "plant",
}
"""What catalogues call things, beside the names that `canonical` knows."""

PASSED_OVER = frozenset(
    {"bar stool", "bunk bed", "cardboard box", "cupboard", "desk lamp", "folding chair",
     "grand piano", "shower stall"}
)  # fmt: skip
"""Pieces that are left out although their category is known: houses generated before it was stay
as they were."""

_ENTRY = re.compile(r"^(\w+)#(\d+)\s*=\s*(.*)$")
_UNICODE = re.compile(r"\\u([0-9a-fA-F]{4})")


@dataclass(frozen=True, eq=False)
class CatalogPiece:
    """One model of a catalogue.

    Attributes:
        archive: The catalogue.
        model: The OBJ file inside it.
        name: What the catalogue calls it.
        category: Canonical.
        size: Width, depth and height, metres.
        rotation: (3, 3) that brings the model upright, its front towards +z.
    """

    archive: Path
    model: str
    name: str
    category: str
    size: Size
    rotation: NDArray[np.float64]

    @property
    def file_name(self) -> str:
        """What its mesh is called beside a house; unique over catalogues."""
        stem = f"{self.archive.stem}_{Path(self.model).with_suffix('').as_posix()}"
        return re.sub(r"[^A-Za-z0-9]+", "_", stem).strip("_") + ".glb"


def read_catalogs(path: Path) -> list[CatalogPiece]:
    """The pieces of a catalogue, or of all catalogues in a folder, whose category is known.

    Raises:
        SceneError: One line: nothing there, not a catalogue, or no piece of a known category.
    """
    archives = sorted(path.glob("*.sh3f")) if path.is_dir() else [path]
    if not archives:
        raise SceneError(f"{path}: no .sh3f catalogue in this folder")
    pieces = [piece for archive in archives for piece in _read_catalog(archive)]
    if not pieces:
        raise SceneError(f"{path}: no piece of furniture of a known category")
    return pieces


def piece_glb(piece: CatalogPiece) -> bytes | None:
    """The model as binary glTF, textures included; None for one that is too fine to draw.

    Raises:
        SceneError: The model is missing or damaged.
    """
    try:
        with zipfile.ZipFile(piece.archive) as archive:
            scene = _load_model(archive, piece.model)
        if sum(len(mesh.faces) for mesh in scene.geometry.values()) > MAX_TRIANGLES:
            return None
        turn = np.eye(4)
        turn[:3, :3] = piece.rotation
        scene.apply_transform(turn)
        return bytes(scene.export(file_type="glb"))
    except Exception as error:
        # The readers of damaged files fail in as many ways as files can be damaged.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(
            f"{piece.archive}: {piece.model}: damaged or incomplete: {reason}"
        ) from error


def _read_catalog(path: Path) -> list[CatalogPiece]:
    try:
        with zipfile.ZipFile(path) as archive:
            text = archive.read(PROPERTIES).decode("latin-1")
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file") from None
    except (zipfile.BadZipFile, KeyError, OSError):
        raise SceneError(f"{path}: not a furniture catalogue (.sh3f) of Sweet Home 3D") from None
    entries = _entries(text.splitlines())
    found = (_piece(path, entries[number]) for number in sorted(entries))
    return [piece for piece in found if piece is not None]


def _entries(lines: Iterable[str]) -> dict[int, dict[str, str]]:
    """The properties of each numbered piece."""
    entries: dict[int, dict[str, str]] = {}
    for line in lines:
        match = _ENTRY.match(line.strip())
        if match:
            value = _UNICODE.sub(lambda code: chr(int(code[1], 16)), match[3].strip())
            entries.setdefault(int(match[2]), {})[match[1]] = value
    return entries


def _piece(path: Path, entry: dict[str, str]) -> CatalogPiece | None:
    """A piece, or None where the entry is of no known category or lacks a model or a size."""
    name = entry.get("name", "")
    category = PIECE_NAMES.get(name.lower()) or canonical(name)
    if name.lower() in PASSED_OVER:
        return None
    if category not in SIZE_RANGES or entry.get("doorOrWindow") == "true":
        return None
    try:
        width, depth, height = (float(entry[key]) / 100.0 for key in ("width", "depth", "height"))
        rotation = np.array(entry.get("modelRotation", "1 0 0 0 1 0 0 0 1").split(), np.float64)
        model, rotation = entry["model"].lstrip("/"), rotation.reshape(3, 3)
    except (KeyError, ValueError):
        return None
    if min(width, depth, height) <= 0.0:
        return None
    return CatalogPiece(path, model, name, category, (width, depth, height), rotation)


def _load_model(archive: zipfile.ZipFile, model: str) -> trimesh.Scene:
    """An OBJ of the archive with its materials, textures no larger than they need be."""
    folder = model.rpartition("/")[0]
    files = {
        name[len(folder) :].lstrip("/"): io.BytesIO(archive.read(name))
        for name in archive.namelist()
        if name.startswith(folder + "/") and not name.endswith("/")
    }
    scene = trimesh.load_scene(
        io.BytesIO(archive.read(model)),
        file_type="obj",
        resolver=trimesh.resolvers.ZipResolver(files),
        process=False,
    )
    if not scene.geometry:
        raise SceneError("no triangles")
    for mesh in scene.geometry.values():
        image = getattr(getattr(mesh.visual, "material", None), "image", None)
        if image is not None:
            image.thumbnail((MAX_TEXTURE_PX, MAX_TEXTURE_PX))
    return scene
