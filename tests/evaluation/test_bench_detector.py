"""What the detector bench counts, held against detectors whose errors are known."""

import numpy as np
import pytest

from toponav.envs.simulator.renderer import RenderedFrame
from toponav.evaluation.bench_detector import COCO_FURNISHING, DetectorBench, matched
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.loading import load_scene
from toponav.types import Detections, Instance, Observation

SIZE = (160, 120)


class Blind:
    """Finds nothing."""

    def detect(self, rgb, vocabulary):
        return Detections.empty(*rgb.shape[:2])


class Raving:
    """Takes the whole of every image for a bicycle."""

    def detect(self, rgb, vocabulary):
        height, width = rgb.shape[:2]
        box = np.array([[0, 0, width, height]], np.float32)
        mask = np.ones((1, height, width), np.bool_)
        return Detections(("bicycle",), np.ones(1, np.float32), box, mask)


def boxes(labels, corners, scores):
    masks = np.zeros((len(labels), 20, 20), np.bool_)
    return Detections(
        tuple(labels), np.array(scores, np.float32), np.array(corners, np.float32), masks
    )


def square(left, top, right, bottom):
    mask = np.zeros((20, 20), np.bool_)
    mask[top:bottom, left:right] = True
    return mask


def test_the_surest_box_takes_the_object_and_others_of_it_are_false() -> None:
    truth = [("chair", square(2, 2, 10, 10)), ("bed", square(12, 12, 20, 20))]
    seen = boxes(
        ["chair", "chair", "chair"],
        [[2, 2, 10, 9], [2, 2, 10, 10], [12, 12, 20, 20]],
        [0.5, 0.9, 0.8],
    )
    assert matched(seen, truth) == {1: 0}


def test_a_box_off_its_object_matches_nothing() -> None:
    truth = [("chair", square(0, 0, 10, 10))]
    assert matched(boxes(["chair"], [[7, 0, 17, 10]], [0.9]), truth) == {}


@pytest.mark.parametrize("detector", [Blind(), Raving()])
def test_who_finds_nothing_has_no_recall(detector) -> None:
    bench = DetectorBench(detector, COCO_FURNISHING)
    bench.examine(load_scene("generated:1"), SIZE, frames=4, seed=0)
    figures = bench.figures()
    classes = figures["by_class"].values()
    assert sum(row["objects"] for row in classes) > 0
    assert all(row["recall"] in (0.0, None) for row in classes)
    false = 4 if isinstance(detector, Raving) else 0
    assert sum(row["false"] for row in classes) == false
    assert sum(row["false"] for row in figures["by_distance"].values()) == false
    assert figures["false_an_image"] == false / 4
    by_score = {"score to 1": false} if false else {}
    assert {name: row["false"] for name, row in figures["by_score"].items()} == by_score
    assert (figures["centroid_m"], figures["cloud_iou"]) == (None, None)


def test_who_knows_the_truth_finds_all_of_it() -> None:
    scene = load_scene("generated:1")
    bench = DetectorBench(Blind(), COCO_FURNISHING)

    class Knowing:
        def detect(self, rgb, vocabulary):
            ids = self.frame.instance_ids
            there = [
                k
                for k in np.unique(ids)
                if k >= 0 and scene.mesh.instances[k].category in vocabulary
            ]
            masks = np.array([ids == k for k in there], np.bool_).reshape(-1, *ids.shape)
            corners = [
                (c.min(), r.min(), c.max() + 1, r.max() + 1) for r, c in map(np.nonzero, masks)
            ]
            return Detections(
                tuple(scene.mesh.instances[k].category for k in there),
                np.ones(len(there), np.float32),
                np.array(corners, np.float32).reshape(-1, 4),
                masks,
            )

    knowing, add = Knowing(), bench.add
    bench.detector = knowing

    def shown(frame, observation, instances):
        knowing.frame = frame
        add(frame, observation, instances)

    bench.add = shown
    bench.examine(scene, SIZE, frames=6, seed=0)
    figures = bench.figures()
    assert {row["recall"] for row in figures["by_class"].values()} <= {1.0, None}
    assert any(row["recall"] == 1.0 for row in figures["by_class"].values())
    assert (figures["centroid_m"], figures["cloud_iou"]) == (0.0, 1.0)


@pytest.mark.parametrize("blank", ["the mask", "the depth"])
def test_a_found_object_without_points_says_nothing_of_clouds(blank) -> None:
    there = square(4, 4, 12, 12)
    mask = np.zeros_like(there) if blank == "the mask" else there

    class Boxing:
        def detect(self, rgb, vocabulary):
            box = np.array([[4, 4, 12, 12]], np.float32)
            return Detections(("bed",), np.ones(1, np.float32), box, mask[None])

    depth = np.full((20, 20), 0.0 if blank == "the depth" else 2.0, np.float32)
    rgb = np.zeros((20, 20, 3), np.uint8)
    ids = np.where(there, 0, -1).astype(np.int32)
    camera = Intrinsics.from_hfov(20, 20, 79.0)
    observation = Observation(rgb, depth, Pose.identity(), Pose.identity(), camera)
    bench = DetectorBench(Boxing(), ("bed",))
    bench.add(RenderedFrame(rgb, depth, ids), observation, [Instance(0, "bed_0", "bed")])
    figures = bench.figures()
    assert figures["by_class"]["bed"]["recall"] == 1.0
    assert (figures["centroid_m"], figures["cloud_iou"]) == (None, None)
