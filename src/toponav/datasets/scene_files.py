"""Which dataset an episode is of, and where its scene is expected to lie."""

from __future__ import annotations

from enum import Enum
from pathlib import Path, PurePosixPath

from toponav.errors import InputError

SCENES_FOLDER = "scene_datasets"
"""Where Habitat's users keep their scenes, within their data folder."""


class Version(Enum):
    """The published datasets, told apart by their scene ids."""

    HM3D_V1 = "hm3d-v1"
    HM3D_V2 = "hm3d-v2"
    MP3D_V1 = "mp3d-v1"
    OTHER = "other"


HM3D_RELEASES = {Version.HM3D_V1: "v0.1", Version.HM3D_V2: "v0.2"}
"""The releases of the scans to which the episodes belong."""


def version_of(scene_id: str) -> Version:
    """The dataset of a scene id such as `hm3d_v0.2/val/00800-TEEsavR23oF/TEEsavR23oF.basis.glb`."""
    match PurePosixPath(scene_id).parts[0]:
        case "hm3d":
            return Version.HM3D_V1
        case "hm3d_v0.2":
            return Version.HM3D_V2
        case "mp3d":
            return Version.MP3D_V1
        case _:
            return Version.OTHER


def scene_name(scene_id: str) -> str:
    """The scene's own name: that of its file without any suffix."""
    return PurePosixPath(scene_id).name.split(".")[0]


def scene_file(scene_id: str, data: Path) -> Path:
    """Where a scene is expected.

    Args:
        scene_id: As in the episode file: a path below `scene_datasets`.
        data: The data folder.

    Raises:
        InputError: The id leads out of that folder.
    """
    inside = PurePosixPath(scene_id)
    if inside.is_absolute() or ".." in inside.parts or not inside.parts:
        raise InputError(f"scene_id {scene_id!r} is no path below {SCENES_FOLDER}")
    return data / SCENES_FOLDER / inside


def missing_scene_message(scene_id: str, data: Path) -> str:
    """One line: which file is missing, where it is expected, and how to come by it."""
    return (
        f"{scene_file(scene_id, data)}: no such scene; {_how_to_get(scene_id)} "
        f"(--data names the folder that holds {SCENES_FOLDER})"
    )


def _how_to_get(scene_id: str) -> str:
    """What a licensee does to have the scene."""
    version = version_of(scene_id)
    if version in HM3D_RELEASES:
        split = (*PurePosixPath(scene_id).parts, "val")[1]
        return (
            "HM3D is licensed: ask for access at matterport.com/habitat-matterport-3d-research-"
            "dataset, then run python -m habitat_sim.utils.datasets_download --uids "
            f"hm3d_{split}_{HM3D_RELEASES[version]}"
        )
    if version is Version.MP3D_V1:
        return (
            "MP3D is licensed: sign the terms of use at niessner.github.io/Matterport, then run "
            "its download_mp.py with --task habitat"
        )
    return "put the dataset's scenes there"
