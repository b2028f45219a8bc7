"""A house becomes the triangles that a simulator loads."""

from __future__ import annotations

from pathlib import Path
from zlib import crc32

import numpy as np

from toponav.categories import canonical
from toponav.errors import SceneError
from toponav.geometry import Pose
from toponav.scenes.building.flights import Stairwell, find_flight, find_stairwells
from toponav.scenes.building.level_structure import LevelStructure
from toponav.scenes.building.object_mesh import fitted, load_object_mesh
from toponav.scenes.building.soup import TriangleSoup
from toponav.scenes.finishes import room_finish
from toponav.scenes.furniture import FurnitureMesh, build_furniture
from toponav.scenes.house import House, HouseObject, Level
from toponav.scenes.mesh import Scene, SceneEpisode, SceneMesh
from toponav.scenes.validation import validate_house

SET_CATEGORIES = frozenset({"chair", "nightstand", "stool"})
"""Of these, pieces of one size are a set: the chairs around a table look alike."""


def build_scene(house: House, base_dir: Path | None = None) -> Scene:
    """Build walls, floors, stairs and furniture.

    Every room has an instance each for its walls, floor and ceiling, named `<room id>/wall` and so
    on; every object is an instance of its own, named by its id. The same house gives the same mesh.

    Args:
        house: What to build.
        base_dir: Where the objects' mesh files lie; needed when an object names one.

    Raises:
        SceneError: One line: the house is not valid, or a mesh file is missing or damaged.
    """
    validate_house(house)
    soup = TriangleSoup()
    _build_structure(soup, house)
    meshes: dict[str, SceneMesh] = {}
    for level in house.levels:
        for item in level.objects:
            if item.mesh is None:
                piece = build_furniture(item.category, item.size, _variant(house, item))
                _add_object(soup, item, piece)
            else:
                if item.mesh not in meshes:
                    meshes[item.mesh] = _load_mesh(item, item.mesh, base_dir)
                _add_object(soup, item, fitted(meshes[item.mesh], item.size))
    return Scene(
        name=house.name,
        mesh=soup.mesh(),
        floors=tuple(sorted(level.floor for level in house.levels if level.rooms)),
        episodes=tuple(
            SceneEpisode(canonical(episode.target), episode.start, episode.yaw)
            for episode in house.episodes
        ),
        room_types=tuple(
            (room.type, index, np.array(room.polygon, dtype=np.float64))
            for index, level in enumerate(house.levels)
            for room in level.rooms
        ),
    )


def _build_structure(soup: TriangleSoup, house: House) -> None:
    wells: list[Stairwell] = []
    for index, stairs in enumerate(house.stairs):
        flight = find_flight(stairs, house.levels)
        wells += find_stairwells(flight, house.levels)
        instance = soup.instance(f"stairs {index}", "stairs")
        for part in flight.steps():
            material = soup.material(part.surface.material)
            soup.add(instance, part.corners, part.uv, [material] * len(part.corners))
    for index, level in enumerate(house.levels):
        if not level.rooms:
            continue
        finishes = [
            room_finish(room.type, _seed(house.name, str(index), room.id)) for room in level.rooms
        ]
        structure = LevelStructure(soup, level, f"level {index}", finishes)
        structure.build(
            floor_wells=[well for well in wells if well.level == index],
            ceiling_wells=[well for well in wells if _opens_ceiling(well, level)],
        )


def _opens_ceiling(well: Stairwell, level: Level) -> bool:
    """Whether the slab of a stairwell is the one above a level."""
    ceiling = level.floor + max(room.height for room in level.rooms)
    return level.floor < well.floor and ceiling >= well.underside


def _variant(house: House, item: HouseObject) -> int:
    """The style of an object: its own, or that of its set."""
    if canonical(item.category) in SET_CATEGORIES:
        return _seed(house.name, item.category, str(item.size))
    return _seed(house.name, item.id)


def _seed(*names: str) -> int:
    """A seed that depends on names alone."""
    return crc32("/".join(names).encode())


def _load_mesh(item: HouseObject, name: str, base_dir: Path | None) -> SceneMesh:
    if base_dir is None:
        raise SceneError(
            f"object {item.id!r} names the mesh {name!r}, but the house has no folder to look in; "
            "save the house beside its meshes and load it from there"
        )
    return load_object_mesh(base_dir / name, item.id)


def _add_object(soup: TriangleSoup, item: HouseObject, piece: FurnitureMesh | SceneMesh) -> None:
    """Place a piece, given in the object's own frame."""
    instance = soup.instance(item.id, canonical(item.category))
    index = [soup.material(material) for material in piece.materials]
    corners = Pose.from_yaw(item.yaw, item.position).apply(piece.vertices)[piece.faces]
    colors = piece.corner_colors if isinstance(piece, SceneMesh) else None
    soup.add(instance, corners, piece.face_uv, (index[k] for k in piece.face_material), colors)
