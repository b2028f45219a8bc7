"""What an image truly shows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from toponav.perception.sightings import SightLog, WitnessedDetector, side_of, witness
from toponav.types import Detections
from true_frames import Truth, true_frame

CATEGORIES = ("wall", "sofa", "chair", "stairs")


def ids() -> np.ndarray:
    image = np.zeros((48, 64), np.int32)
    image[10:20, 20:36] = 1
    image[12:16, 24:28] = 0  # something stands in front of the sofa
    image[40:48, 60:64] = 2
    image[0, 0] = -1
    return image


def test_objects_are_counted_and_measured_and_walls_are_none() -> None:
    shown = witness(true_frame(ids(), CATEGORIES, depth_m=3.0))
    sofa, chair = shown.sightings
    assert (sofa.instance.category, chair.instance.category) == ("sofa", "chair")
    assert sofa.pixels == 10 * 16 - 16
    assert sofa.relative_size == pytest.approx(math.sqrt(sofa.pixels / (48 * 64)))
    assert sofa.window == (slice(10, 20), slice(20, 36))
    assert sofa.range_m == pytest.approx(3.0)
    assert not sofa.cut
    assert chair.cut


def test_few_pixels_are_not_counted() -> None:
    shown = witness(true_frame(ids(), CATEGORIES), least_pixels=33)
    assert [sighting.instance.category for sighting in shown.sightings] == ["sofa"]


def test_the_range_is_the_median_so_that_stray_pixels_do_not_matter() -> None:
    depth = np.full((48, 64), 2.5, np.float32)
    depth[10:12, 20:24] = 40.0
    sofa = witness(true_frame(ids(), CATEGORIES, depth)).sightings[0]
    assert sofa.range_m == pytest.approx(2.5)


def test_an_object_has_the_same_side_however_the_camera_turns() -> None:
    """The camera turns right by as much as the object moves left in the image."""
    image, turned = np.full((2, 49, 65), -1, np.int32)
    image[24, 32] = turned[24, 0] = 0
    left = witness(true_frame(turned, ["sofa"])).sightings[0]
    bearing = math.atan2(32.0, true_frame(turned).intrinsics.fx)
    ahead = witness(true_frame(image, ["sofa"], yaw=bearing - 0.0)).sightings[0]
    assert left.side[0] == ahead.side[0]


def test_sides_are_sectors_and_ranges() -> None:
    offsets = [np.array([r * math.cos(a), r * math.sin(a), 0.0]) for r in (1.1, 2.0)
               for a in np.radians([10, 30, 50, 350])]  # fmt: skip
    sides = [side_of(offset) for offset in offsets]
    assert sides[0] == sides[1] != sides[2]
    assert len(set(sides)) == 6
    assert {side_of(np.zeros(3)), side_of(np.array([0.05, 0.0, 0.0]))} == {side_of(np.zeros(3))}


def test_places_are_coarse() -> None:
    a, b = (witness(true_frame(ids(), CATEGORIES, yaw=yaw)).place for yaw in (0.1, 0.2))
    np.testing.assert_array_equal(a, b)
    assert (witness(true_frame(ids(), CATEGORIES, yaw=0.8)).place != a).any()


def test_a_log_knows_the_images_that_it_was_asked_to_keep() -> None:
    truth = Truth(true_frame(ids(), CATEGORIES))
    log = SightLog(truth)
    images = [np.zeros((48, 64, 3), np.uint8) for _ in range(4)]
    log.look(images[0])
    assert log.of(images[0]) is None
    log.keep(2)
    for image in images[1:]:
        log.look(image)
    assert [log.of(image) is None for image in images] == [True, True, False, False]
    shown = log.of(images[3])
    assert shown is not None
    assert [sighting.instance.category for sighting in shown.sightings] == ["sofa", "chair"]
    assert log.of(images[3].copy()) is None


def test_a_witnessed_detector_tells_the_log_and_answers_as_ever() -> None:
    class Nothing:
        def detect(self, rgb: np.ndarray, vocabulary: object) -> Detections:
            return nothing

    nothing, image = Detections.empty(48, 64), np.zeros((48, 64, 3), np.uint8)
    log = SightLog(Truth(true_frame(ids(), CATEGORIES)))
    log.keep(1)
    assert WitnessedDetector(Nothing(), log).detect(image, ("sofa",)) is nothing
    assert log.of(image) is not None
