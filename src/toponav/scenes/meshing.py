"""From a house to triangles: walls with their openings cut, floors, ceilings, stairs, furniture."""

from __future__ import annotations

import zlib
from pathlib import Path

import numpy as np
from shapely.geometry import Polygon

from toponav.categories import canonical
from toponav.geometry import Pose
from toponav.scenes.furniture import FurnitureMesh, build_furniture
from toponav.scenes.house import House, HouseObject
from toponav.scenes.level_meshing import LevelMesher
from toponav.scenes.mesh import Scene, SceneEpisode, SceneMesh
from toponav.scenes.mesh_builder import MeshBuilder
from toponav.scenes.object_meshes import load_object_mesh
from toponav.scenes.stairs_meshing import add_stairs, stairwell


def build_scene(house: House, base_dir: Path | None = None) -> Scene:
    """The scene that a house describes.

    Args:
        house: A valid house.
        base_dir: Where the mesh files of its objects lie; by default the working directory.

    Raises:
        SceneError: An object's mesh file is missing or cannot be read.
    """
    builder = MeshBuilder()
    holes: list[list[Polygon]] = [[] for _ in house.levels]
    for stairs in house.stairs:
        upper = max(stairs.from_level, stairs.to_level, key=lambda k: house.levels[k].floor)
        holes[upper].append(stairwell(stairs, house.levels))
    for index, level in enumerate(house.levels):
        above = holes[index + 1] if index + 1 < len(holes) else []
        LevelMesher(builder, level, index).add(floor_holes=holes[index], ceiling_holes=above)
        for item in level.objects:
            _add_object(builder, item, base_dir or Path())
    for number, stairs in enumerate(house.stairs):
        add_stairs(builder, stairs, house.levels, f"stairs_{number}")
    return Scene(
        name=house.name,
        mesh=builder.build(),
        floors=tuple(sorted(level.floor for level in house.levels)),
        episodes=tuple(
            SceneEpisode(episode.target, episode.start, episode.yaw) for episode in house.episodes
        ),
        room_types=tuple(
            (room.type, index, np.asarray(room.polygon, dtype=np.float64))
            for index, level in enumerate(house.levels)
            for room in level.rooms
        ),
    )


def _add_object(builder: MeshBuilder, item: HouseObject, base_dir: Path) -> None:
    """Place an object: its own mesh, or a shape of its category."""
    world_from_object = Pose.from_yaw(item.yaw, item.position)
    instance = builder.instance(item.id, item.category)
    mesh: SceneMesh | FurnitureMesh
    if item.mesh is not None:
        mesh = load_object_mesh(item, base_dir)
    else:
        mesh = build_furniture(canonical(item.category), item.size, zlib.crc32(item.id.encode()))
    materials = np.array([builder.material(material) for material in mesh.materials])
    builder.add(
        world_from_object.apply(mesh.vertices),
        mesh.faces,
        materials[mesh.face_material],
        instance,
        mesh.face_uv,
    )
