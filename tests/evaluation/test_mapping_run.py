"""Map and memory from a recording, end to end."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from recorded_hall import FLOOR_Z, write_recording
from toponav.config import NavigatorConfig
from toponav.envs.recording import open_recording
from toponav.evaluation.mapping_run import NODE_SPACING_M, map_recording, write_clouds
from toponav.geometry import Pose
from toponav.types import Detections


class LeftHalfIsCounter:
    """Calls the left half of every image a counter, and remembers what it was asked for."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, ...]] = []

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        self.asked.append(tuple(vocabulary))
        height, width = rgb.shape[:2]
        masks = np.zeros((1, height, width), np.bool_)
        masks[0, :, : width // 2] = True
        box = np.array([[0, 0, width // 2, height]], np.float32)
        return Detections(("counter",), np.ones(1, np.float32), box, masks)


class TwoNames:
    """Calls one thing by two names, of which it is surer of the first."""

    def detect(self, rgb: NDArray[np.uint8], vocabulary: Sequence[str]) -> Detections:
        one = LeftHalfIsCounter().detect(rgb, vocabulary)
        scores = np.array([0.9, 0.6], np.float32)
        both = [np.repeat(array, 2, axis=0) for array in (one.boxes, one.masks)]
        return Detections(("counter", "bench"), scores, *both)


def test_of_two_names_for_one_thing_the_likelier_stays(tmp_path: Path) -> None:
    write_recording(tmp_path, Pose.identity())
    run = map_recording(open_recording(tmp_path), TwoNames())
    assert list(run.view.objects) == ["counter"]


def test_a_recording_gives_a_map_a_memory_and_its_path(tmp_path: Path) -> None:
    poses = write_recording(tmp_path, Pose.identity(), count=24)
    detector, progress = LeftHalfIsCounter(), []
    config = NavigatorConfig(vocabulary=("counter", "bed"))
    run = map_recording(
        open_recording(tmp_path), detector, config, lambda *done: progress.append(done)
    )
    assert progress == [(k + 1, 24) for k in range(24)]
    assert detector.asked == [("counter", "bed")] * 24
    np.testing.assert_allclose(run.trajectory[:, 0], [p.translation[0] for p in poses], atol=1e-6)
    np.testing.assert_allclose(run.trajectory[:, 2], FLOOR_Z, atol=0.01)
    assert 0 < len(run.view.objects["counter"]) < len(run.view.scene)
    length = 0.2 * 23
    assert len(run.memory.nodes) == 1 + int(length / NODE_SPACING_M)
    assert run.memory.nodes[0].objects == ("counter",)
    assert run.map_bytes > 0


def test_without_a_detector_the_map_has_no_objects(tmp_path: Path) -> None:
    write_recording(tmp_path, Pose.identity())
    run = map_recording(open_recording(tmp_path))
    assert not run.view.objects
    assert len(run.view.scene) > 100


def test_clouds_are_written_by_name_and_read_back(tmp_path: Path) -> None:
    write_recording(tmp_path / "hall", Pose.identity())
    view = map_recording(open_recording(tmp_path / "hall"), LeftHalfIsCounter()).view
    paths = write_clouds(view, tmp_path / "out")
    assert sorted(paths) == ["navigable", "objects/counter", "obstacles", "scene"]
    for name, cloud in (("scene", view.scene), ("objects/counter", view.objects["counter"])):
        vertices = trimesh.load(paths[name]).vertices
        np.testing.assert_array_equal(vertices.astype(np.float32), cloud.points)
