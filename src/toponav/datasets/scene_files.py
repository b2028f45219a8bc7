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


_ANNOTATIONS = {
    Version.HM3D_V1: (".semantic.glb", ".semantic.txt"),
    Version.HM3D_V2: (".semantic.glb", ".semantic.txt"),
    Version.MP3D_V1: (".house", "_semantic.ply"),
    Version.OTHER: (),
}
"""How the names of the annotations end; those of other datasets are not known beforehand."""

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


def scene_files(scene_id: str, data: Path) -> tuple[Path, ...]:
    """A scene and the annotations that its dataset publishes beside it.

    Args:
        scene_id: As in the episode file.
        data: The data folder.

    Raises:
        InputError: The id leads out of the folder of the scenes.
    """
    stage, name = scene_file(scene_id, data), scene_name(scene_id)
    annotations = tuple(stage.with_name(name + end) for end in _ANNOTATIONS[version_of(scene_id)])
    return (stage, *annotations)


def missing_file(scene_id: str, data: Path) -> str | None:
    """One line about the first of a scene's files that is missing; None where all are there.

    It says where the file is expected and how to come by it.

    Raises:
        InputError: The id leads out of the folder of the scenes.
    """
    for path in scene_files(scene_id, data):
        if not path.is_file():
            return (
                f"{path}: no such file; {_how_to_get(scene_id)} (--data names the folder that "
                f"holds {SCENES_FOLDER})"
            )
    return None


def _how_to_get(scene_id: str) -> str:
    """What a licensee does to have the scene and its annotations."""
    version = version_of(scene_id)
    if version in HM3D_RELEASES:
        folder, split = (*PurePosixPath(scene_id).parts, "val")[:2]
        release = HM3D_RELEASES[version]
        return (
            "HM3D is licensed: ask for access at matterport.com/habitat-matterport-3d-research-"
            f"dataset, run python -m habitat_sim.utils.datasets_download --uids hm3d_{split}_"
            f"{release}, and let {SCENES_FOLDER}/{folder} be (a link to) what it puts into "
            f"versioned_data/hm3d-{release[1:]}/hm3d"
        )
    if version is Version.MP3D_V1:
        return (
            "MP3D is licensed: sign the terms of use at niessner.github.io/Matterport, then run "
            "its download_mp.py with --task habitat"
        )
    return "put the dataset's scenes there"
