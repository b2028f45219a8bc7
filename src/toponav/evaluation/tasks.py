"""What there is to run: the episodes of a source as tasks, and who may run which next."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from toponav.errors import InputError


@dataclass(frozen=True)
class Task:
    """One episode to run.

    Attributes:
        spec: What its source loads the scene from.
        scene: The scene's name; (scene, index) is the episode's key in every result.
        index: Index among the scene's episodes.
    """

    spec: str
    scene: str
    index: int

    @property
    def key(self) -> tuple[str, int]:
        """(scene, index), as that of the result."""
        return self.scene, self.index


@dataclass(frozen=True)
class SceneOutline:
    """What is known of a scene before it is loaded.

    Attributes:
        spec: What loads it.
        name: Unique among the scenes of a source.
        episodes: How many episodes it brings.
    """

    spec: str
    name: str
    episodes: int


def plan(scenes: Sequence[SceneOutline], total: int | None) -> list[Task]:
    """The episodes to run, scene by scene.

    Args:
        scenes: Where.
        total: How many in all, spread evenly with the remainder to the first scenes; None takes
            those that the scenes bring, and one of a scene that brings none.

    Raises:
        InputError: Two scenes share a name, or the number is not positive.
    """
    if total is not None and total < 1:
        raise InputError(f"--episodes takes a positive number, not {total}")
    twice = [name for name, count in Counter(s.name for s in scenes).items() if count > 1]
    if twice:
        raise InputError(f"two scenes are called {twice[0]!r}: give each its own name")
    tasks = []
    for number, scene in enumerate(scenes):
        if total is None:
            count = max(scene.episodes, 1)
        else:
            count = total // len(scenes) + (1 if number < total % len(scenes) else 0)
        tasks += [Task(scene.spec, scene.name, index) for index in range(count)]
    return tasks


def shard(tasks: Sequence[Task], text: str) -> list[Task]:
    """The part of the tasks that `text`, "i/n" with i from 1 to n, stands for.

    Shards are runs of neighbouring tasks, so that a scene is loaded by few of them; together they
    are all tasks, and no task is in two.

    Raises:
        InputError: Not such a text.
    """
    first, slash, second = text.partition("/")
    if not (slash and first.isdecimal() and second.isdecimal() and 1 <= int(first) <= int(second)):
        raise InputError(f"--shard takes i/n with i from 1 to n, such as 2/8, not {text!r}")
    i, n = int(first), int(second)
    return list(tasks[(i - 1) * len(tasks) // n : i * len(tasks) // n])


class TaskQueue:
    """Hands out tasks so that a worker stays in the scene that it has loaded.

    A worker gets the tasks of its own scene first, then those of a scene that nobody is in, then
    one of the scene with most left. The order in which tasks are handed out has no influence on
    their results.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        """Take the tasks; a scene's are handed out in their order."""
        self._waiting: dict[str, deque[Task]] = {}
        for task in tasks:
            self._waiting.setdefault(task.scene, deque()).append(task)
        self._scene_of: dict[int, str] = {}

    def __len__(self) -> int:
        return sum(map(len, self._waiting.values()))

    def take(self, worker: int) -> Task | None:
        """The next task for a worker; None when nothing is left."""
        scene = self._next_scene(worker)
        if scene is None:
            return None
        self._scene_of[worker] = scene
        task = self._waiting[scene].popleft()
        if not self._waiting[scene]:
            del self._waiting[scene]
        return task

    def give_back(self, task: Task) -> None:
        """A task that was not finished goes to the front of its scene's."""
        self._waiting.setdefault(task.scene, deque()).appendleft(task)

    def clear(self) -> None:
        """Nothing further is handed out."""
        self._waiting.clear()

    def _next_scene(self, worker: int) -> str | None:
        own = self._scene_of.get(worker)
        if own in self._waiting:
            return own
        others = {scene for k, scene in self._scene_of.items() if k != worker}
        free = next((scene for scene in self._waiting if scene not in others), None)
        if free is not None:
            return free
        return max(self._waiting, key=lambda scene: len(self._waiting[scene]), default=None)
