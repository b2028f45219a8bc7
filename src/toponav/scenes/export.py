"""Writing houses and scenes for other tools: house JSON, and glTF with categories in `extras`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from toponav.errors import SceneError
from toponav.geometry.conventions import HABITAT_FROM_WORLD
from toponav.scenes.house import House
from toponav.scenes.house_io import replace_file, save_house
from toponav.scenes.mesh import Material, Scene, SceneMesh
from toponav.scenes.meshing import build_scene

EXPORT_SUFFIXES = (".json", ".glb")
"""House files, and binary glTF."""


def export_house(source: House | Scene, path: Path | str, base_dir: Path | None = None) -> None:
    """Write a house or a scene in the format that the path's suffix names.

    A `.glb` holds one node an instance, named like it, with `extras.category`; `load_mesh_scene`
    reads the same instances from it.

    Args:
        source: What to write; a `.json` file holds a house, never a mere mesh.
        path: A `.json` or `.glb` file; an older one is replaced.
        base_dir: Where the meshes of a house's objects lie.

    Raises:
        SceneError: Unknown suffix, a mesh as `.json`, or the file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in EXPORT_SUFFIXES:
        raise SceneError(f"{path}: exports are {' or '.join(EXPORT_SUFFIXES)} files")
    if suffix == ".json":
        if not isinstance(source, House):
            raise SceneError(f"{path}: a mesh has no plan of its rooms; export it as .glb")
        save_house(source, path)
        return
    scene = build_scene(source, base_dir) if isinstance(source, House) else source
    replace_file(path, scene_to_glb(scene))


def scene_to_glb(scene: Scene) -> bytes:
    """The scene as binary glTF, y up as its specification wants."""
    vertices = HABITAT_FROM_WORLD.apply(scene.mesh.vertices)
    materials = [_pbr_material(material) for material in scene.mesh.materials]
    exported = trimesh.Scene()
    for instance in scene.mesh.instances:
        of_instance = scene.mesh.face_instance == instance.id
        used = np.unique(scene.mesh.face_material[of_instance])
        if not len(used):
            continue
        exported.graph.update(frame_to=instance.name, metadata={"category": instance.category})
        for index in used:
            faces = np.flatnonzero(of_instance & (scene.mesh.face_material == index))
            name = f"{instance.name}/{index}"
            exported.add_geometry(
                _corners_mesh(scene.mesh, vertices, faces, materials[index]),
                node_name=name,
                geom_name=name,
                parent_node_name=instance.name,
            )
    content: bytes = exported.export(file_type="glb")
    return content


def _pbr_material(material: Material) -> PBRMaterial:
    return PBRMaterial(
        name=material.name,
        baseColorTexture=Image.fromarray(material.texture),
        metallicFactor=0.0,
        roughnessFactor=1.0,
        doubleSided=True,
    )


def _corners_mesh(
    mesh: SceneMesh, vertices: NDArray[np.float64], faces: NDArray[Any], material: PBRMaterial
) -> trimesh.Trimesh:
    """Some faces with a vertex for each of their corners, as texture seams need."""
    corners = vertices[mesh.faces[faces]].reshape(-1, 3)
    visual = TextureVisuals(uv=mesh.face_uv[faces].reshape(-1, 2), material=material)
    if mesh.corner_colors is not None:
        colors = mesh.corner_colors[faces].reshape(-1, 3)
        visual.vertex_attributes["color"] = np.pad(colors, ((0, 0), (0, 1)), constant_values=255)
    return trimesh.Trimesh(
        vertices=corners,
        faces=np.arange(len(corners)).reshape(-1, 3),
        visual=visual,
        process=False,
    )
