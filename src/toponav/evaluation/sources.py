"""What an evaluation runs on: scenes with their own episodes, or a dataset's episodes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Protocol

from toponav.datasets import (
    ObjectNavEpisode,
    benchmark_file,
    is_benchmark,
    is_objectnav_file,
    load_objectnav,
    missing_file,
    scene_file,
)
from toponav.datasets.scene_files import scene_name
from toponav.errors import SceneError
from toponav.evaluation.tasks import SceneOutline
from toponav.scenes.loading import list_scenes, load_scene, scene_outline
from toponav.scenes.mesh import Scene, SceneEpisode


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


@dataclass(frozen=True)
class ObjectNavSource:
    """An ObjectNav episode file in Habitat's format.

    Attributes:
        path: The split's file, or one scene's.
        data: Folder that holds `scene_datasets`.
    """

    path: Path
    data: Path

    def outlines(self) -> list[SceneOutline]:
        """The scenes, in the order of the file; one that lacks a file is an error."""
        counts = Counter(episode.scene_id for episode in self._episodes)
        for scene_id in counts:
            if (missing := missing_file(scene_id, self.data)) is not None:
                raise SceneError(missing)
        return [SceneOutline(key, scene_name(key), count) for key, count in counts.items()]

    def load(self, spec: str) -> Scene:
        """A scene with the file's episodes, and the viewpoints by which they are scored."""
        scene = load_scene(str(scene_file(spec, self.data)))
        own = [episode for episode in self._episodes if episode.scene_id == spec]
        return replace(
            scene,
            name=scene_name(spec),
            stage=scene_file(spec, self.data),
            episodes=tuple(SceneEpisode(e.target, e.start, e.yaw) for e in own),
            viewpoints={episode.target: episode.viewpoints for episode in own},
        )

    @cached_property
    def _episodes(self) -> tuple[ObjectNavEpisode, ...]:
        return load_objectnav(self.path).episodes


def open_source(source: str, labels: Path | None, data: Path) -> Source:
    """What a SOURCE on the command line stands for.

    Args:
        source: What the user typed.
        labels: Label table of mesh scenes.
        data: Habitat's data folder, for an episode file or a benchmark's name.

    Raises:
        InputError: The episode file of a benchmark is missing.
    """
    if is_benchmark(source):
        return ObjectNavSource(benchmark_file(source, data), data)
    if is_objectnav_file(Path(source)):
        return ObjectNavSource(Path(source), data)
    return SceneSource(source, labels)
