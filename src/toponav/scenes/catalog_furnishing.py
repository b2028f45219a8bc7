"""Real furniture models in place of the drawn shapes of a house."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from zlib import crc32

from toponav.categories import canonical
from toponav.scenes.furniture.shape import Size
from toponav.scenes.house import House, HouseObject
from toponav.scenes.house_io import replace_file
from toponav.scenes.meshing import SET_CATEGORIES
from toponav.scenes.sweet_home import CatalogPiece, piece_glb

MODEL_FOLDER = "models"
"""Where the meshes lie, beside the houses that use them."""

MAX_DISTORTION = 1.6
"""A piece is passed over when filling an object's box stretches one axis this much more than
another."""

FLAT_SHARE = 1 / 3
"""A side this short beside the longest is a thickness, and may be any: nobody can tell how thick a
television on the wall is."""


class FurnitureLibrary:
    """Gives the objects of houses the models of a catalogue, and writes those that are used."""

    def __init__(self, pieces: Sequence[CatalogPiece], folder: Path) -> None:
        """Choose among `pieces`; `folder` is where the houses will be saved."""
        self._folder = folder
        self._written: dict[str, bool] = {}
        self._pieces: dict[str, list[CatalogPiece]] = defaultdict(list)
        for piece in pieces:
            self._pieces[piece.category].append(piece)

    def furnish(self, house: House) -> House:
        """The house with a model for every object that one suits; sizes and places stay.

        The same house and catalogue give the same result.

        Raises:
            SceneError: A model is damaged, or a file cannot be written.
        """
        levels = [
            level.model_copy(
                update={"objects": [self._with_model(house, item) for item in level.objects]}
            )
            for level in house.levels
        ]
        return house.model_copy(update={"levels": levels})

    def _with_model(self, house: House, item: HouseObject) -> HouseObject:
        if item.mesh is not None:
            return item
        category = canonical(item.category)
        # Equal pieces of a set are equal in the catalogue's models too.
        key = str(item.size) if category in SET_CATEGORIES else item.id
        suited = [
            p for p in self._pieces[category] if distortion(p.size, item.size) <= MAX_DISTORTION
        ]
        suited.sort(key=lambda p: crc32(f"{house.name}/{category}/{key}/{p.file_name}".encode()))
        for piece in suited:
            if self._write(piece):
                return item.model_copy(update={"mesh": f"{MODEL_FOLDER}/{piece.file_name}"})
        return item

    def _write(self, piece: CatalogPiece) -> bool:
        """Whether the piece's mesh lies in the folder now."""
        name = piece.file_name
        if name not in self._written:
            data = piece_glb(piece)
            if data is not None:
                replace_file(self._folder / MODEL_FOLDER / name, data)
            self._written[name] = data is not None
        return self._written[name]


def distortion(size: Size, target: Size) -> float:
    """How much more one axis is stretched than another, at least 1, to make `size` `target`.

    What is a thickness in both does not count.
    """
    scales = [
        goal / extent
        for goal, extent in zip(target, size, strict=True)
        if extent > FLAT_SHARE * max(size) or goal > FLAT_SHARE * max(target)
    ]
    return max(scales) / min(scales)
