"""What an evaluation runs on: scenes with their own episodes, or a dataset's episodes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from toponav.evaluation.tasks import SceneOutline
from toponav.scenes.loading import list_scenes, load_scene, scene_outline
from toponav.scenes.mesh import Scene


class Source(Protocol):
    """Scenes and their episodes; small, so that it can be sent to a worker."""

    def outlines(self) -> list[SceneOutline]:
        """The scenes, in a stable order, without loading them.

        Raises:
            InputError: There is none, or one is missing.
        """
        ...

    def load(self, spec: str) -> Scene:
        """A scene with its episodes.

        Raises:
            SceneError: It cannot be loaded.
        """
        ...


@dataclass(frozen=True)
class SceneSource:
    """A house, a mesh scene, a generator spec or range, or a folder of scenes.

    Attributes:
        source: What the user typed.
        labels: Label table of mesh scenes.
    """

    source: str
    labels: Path | None = None

    def outlines(self) -> list[SceneOutline]:
        """The scenes, in a stable order."""
        return [SceneOutline(spec, *scene_outline(spec)) for spec in list_scenes(self.source)]

    def load(self, spec: str) -> Scene:
        """The scene."""
        return load_scene(spec, self.labels)


def open_source(source: str, labels: Path | None, data: Path) -> Source:
    """What a SOURCE on the command line stands for.

    Args:
        source: What the user typed.
        labels: Label table of mesh scenes.
        data: Where the scenes of an episode file lie.
    """
    del data
    return SceneSource(source, labels)
