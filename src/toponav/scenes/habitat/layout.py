"""Where the files of a Habitat scene lie beside its `.glb`."""

from __future__ import annotations

from pathlib import Path

CONFIG_SUFFIX = ".scene_dataset_config.json"

LEVELS_UP = 3
"""A dataset's configuration lies at most so many folders above a scene's."""


def stage_name(stage: Path) -> str:
    """The scene's own name: `TEEsavR23oF` of `TEEsavR23oF.basis.glb`."""
    return stage.name.split(".")[0]


def dataset_config(stage: Path) -> Path | None:
    """The configuration of the dataset that a scene belongs to; the annotated one of several."""
    for folder in list(stage.parents)[: LEVELS_UP + 1]:
        found = sorted(folder.glob(f"*{CONFIG_SUFFIX}"))
        if found:
            return next((path for path in found if "annotated" in path.name), found[0])
    return None
