"""The detector's noise model: nothing at rate zero, and the documented rates otherwise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from small_house import small_runner
from toponav.categories import DEFAULT_VOCABULARY
from toponav.errors import InputError
from toponav.geometry import Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.perception import NoisyDetector, NoisyDetectorConfig, OracleDetector
from toponav.perception.lookalikes import LOOKALIKES
from toponav.perception.noisy import PERFECT
from toponav.types import Action, Detections, SemanticFrame
from true_frames import EYE_M, Truth, true_frame

EVERY_SIDE = [(yaw, depth) for yaw in np.radians(np.arange(0, 360, 45) + 10.0)
              for depth in (1.2, 1.9, 2.8, 4.0)]  # fmt: skip


def facing(category: str, size: int = 40, depth_m: float = 2.0, yaw: float = 0.0) -> SemanticFrame:
    """A square object of that many pixels in the middle of a 160 x 120 image of a wall."""
    image = np.zeros((120, 160), np.int32)
    image[60 - size // 2 : 60 + size // 2, 80 - size // 2 : 80 + size // 2] = 1
    return true_frame(image, ("wall", category), depth_m, yaw)


def detect(
    frame: SemanticFrame, vocabulary: Sequence[str], seed: int, config: NoisyDetectorConfig
) -> Detections:
    height, width = frame.instance_ids.shape
    image = np.zeros((height, width, 3), np.uint8)
    return NoisyDetector(Truth(frame), seed, config).detect(image, vocabulary)


def rate(label: str, vocabulary: Sequence[str], config: NoisyDetectorConfig, **frame: int) -> float:
    """Share of houses in which a chair of an image is labelled so."""
    seen = (detect(facing("chair", **frame), vocabulary, seed, config) for seed in range(1500))
    return float(np.mean([label in detections.labels for detections in seen]))


def quiet(**changes: object) -> NoisyDetectorConfig:
    return PERFECT.model_copy(update=changes)


def test_without_errors_it_is_the_oracle_but_for_the_scores() -> None:
    env = small_runner().env
    env.reset(seed=0, options={"target": "toilet"})
    noisy, oracle = NoisyDetector(env.oracle, 4, PERFECT), OracleDetector(env.oracle)
    for action in [Action.TURN_LEFT, Action.MOVE_FORWARD] * 8:
        image = env.observe().rgb
        seen, true = (d.detect(image, DEFAULT_VOCABULARY) for d in (noisy, oracle))
        assert seen.labels == true.labels
        np.testing.assert_array_equal(seen.boxes, true.boxes)
        np.testing.assert_array_equal(seen.masks, true.masks)
        env.step(int(action))


@pytest.mark.parametrize("size", [6, 16, 60])
def test_recall_is_that_of_the_size(size: int) -> None:
    config = quiet(sight=NoisyDetectorConfig().sight)
    expected = config.sight.recall(size / math.sqrt(160 * 120), 2.0)
    assert rate("chair", ["chair"], config, size=size) == pytest.approx(expected, abs=0.04)


def test_confusions_happen_at_their_rates_and_only_within_the_vocabulary() -> None:
    config = quiet(confusion=2.0)
    expected = 2.0 * LOOKALIKES["chair"]["sofa"]
    assert rate("sofa", ["chair", "sofa"], config) == pytest.approx(expected, abs=0.025)
    assert rate("chair", ["chair", "bed"], config) == 1.0
    assert rate("sofa", ["sofa"], config) == pytest.approx(2.0 * expected, abs=0.03)
    assert rate("sofa", ["chair", "sofa"], quiet()) == 0.0


def test_the_outcome_from_one_side_is_one_outcome() -> None:
    sight = NoisyDetectorConfig().sight.model_copy(update={"object_share": 0.3, "side_share": 0.7})
    config = quiet(sight=sight, confusion=3.0)
    for seed in range(40):
        near_poses = [
            facing("chair", 14, 2.0 + dz, dyaw) for dz in (0.0, 0.02) for dyaw in (0.1, 0.2)
        ]
        seen = {detect(frame, ["chair", "sofa"], seed, config).labels for frame in near_poses}
        assert len(seen) == 1
    all_sides = {
        detect(facing("chair", 14, depth, yaw), ["chair", "sofa"], 3, config).labels
        for yaw, depth in EVERY_SIDE
    }
    assert len(all_sides) > 1


def test_the_order_of_the_images_changes_nothing() -> None:
    frames = [facing("chair", 16, depth, yaw) for yaw, depth in EVERY_SIDE]
    truth = Truth(frames[0])
    detector = NoisyDetector(truth, 9)
    image = np.zeros((120, 160, 3), np.uint8)

    def seen(order: Sequence[int]) -> dict[int, tuple[tuple[str, ...], bytes]]:
        answers = {}
        for k in order:
            truth.frame = frames[k]
            detections = detector.detect(image, DEFAULT_VOCABULARY)
            answers[k] = (detections.labels, detections.scores.tobytes())
        return answers

    forward = seen(range(len(frames)))
    assert forward == seen(range(len(frames))[::-1])
    assert len({labels for labels, _ in forward.values()}) > 1


def test_scores_of_right_labels_are_higher_and_none_is_below_the_threshold() -> None:
    config = quiet(confusion=4.0)
    right, wrong = [], []
    for seed in range(800):
        seen = detect(facing("chair"), ["chair", "sofa"], seed, config)
        (right if seen.labels == ("chair",) else wrong).append(float(seen.scores[0]))
    assert min(right + wrong) >= np.float32(config.least_score)
    assert max(right + wrong) <= 1.0
    assert len(wrong) > 100
    assert np.mean(right) > np.mean(wrong) + 0.1


def wall_from(step_m: float) -> SemanticFrame:
    """A bare wall 2 m before the origin, from a step nearer to it."""
    frame = true_frame(np.zeros((120, 160), np.int32), ["wall"], 2.0 - step_m)
    pose = Pose.from_yaw(0.0, (step_m, 0.0, EYE_M)) @ BODY_FROM_OPTICAL
    return replace(frame, world_from_camera=pose)


def test_a_patch_deceives_again_from_the_next_pose_and_lies_where_it_lay() -> None:
    config, seen_twice, overlapping = quiet(patch_rate=0.1), 0, 0
    for seed in range(100):
        first, second = (
            detect(wall_from(step), ["tv_monitor"], seed, config) for step in (0.0, 0.02)
        )
        if len(first) == 1:
            seen_twice += len(second) == 1
            overlap = np.count_nonzero(first.masks & second.masks[:1])
            overlapping += overlap > 0.5 * np.count_nonzero(first.masks)
    assert seen_twice > 15
    assert overlapping > 0.9 * seen_twice


def test_patches_are_as_frequent_as_the_rate_and_never_on_what_they_look_like() -> None:
    wall = true_frame(np.zeros((120, 160), np.int32), ["wall"], 2.0)
    sofa = true_frame(np.zeros((120, 160), np.int32), ["sofa"], 2.0)
    counts = {
        share: sum(
            len(detect(wall, ["sofa", "bed"], s, quiet(patch_rate=share))) for s in range(400)
        )
        for share in (0.0, 0.005, 0.02)
    }
    assert counts[0.0] == 0
    assert counts[0.02] == pytest.approx(4 * counts[0.005], rel=0.5)
    for seed in range(100):
        seen = detect(sofa, ["sofa", "bed"], seed, quiet(patch_rate=0.05))
        assert seen.labels.count("sofa") == 1


def test_boundaries_are_off_by_the_given_number_of_pixels() -> None:
    config = quiet(boundary_px=8.0)
    sides = [
        math.sqrt(np.count_nonzero(detect(facing("chair"), ["chair"], seed, config).masks))
        for seed in range(600)
    ]
    off = (np.array(sides) - 40.0) / 2.0
    assert off.mean() == pytest.approx(0.0, abs=0.4)
    assert off.std() == pytest.approx(8.0 * 160 / 640, rel=0.3)
    assert min(sides) > 0.0


def test_an_image_that_is_not_the_last_one_is_refused() -> None:
    detector = NoisyDetector(Truth(facing("chair")), 0)
    with pytest.raises(InputError, match="last observed"):
        detector.detect(np.zeros((4, 4, 3), np.uint8), ["chair"])


@pytest.mark.parametrize("radii", [(0.5, 0.2), (0.0, 0.2)])
def test_radii_that_make_no_sense_are_refused(radii: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="two radii"):
        NoisyDetectorConfig(patch_radius_m=radii)
