"""From boxes to objects: floor, wall and what stands in front are not part of the thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from small_house import small_runner
from toponav.geometry import Intrinsics, Pose
from toponav.geometry.conventions import BODY_FROM_OPTICAL
from toponav.perception import OracleDetector
from toponav.perception.object_masks import object_masks
from toponav.types import Action, Detections, Observation

CAMERA = Intrinsics.from_hfov(160, 120, 79.0)
EYE_M, WALL_M = 0.88, 4.0


def room(cube_m: float | None = None) -> tuple[Observation, NDArray[np.bool_]]:
    """A floor, a wall and a cube 0.6 m wide and high at a distance; and where the cube is."""
    rays = CAMERA.rays()
    with np.errstate(divide="ignore"):
        floor = np.where(rays[..., 1] > 0.0, EYE_M / rays[..., 1], np.inf)
    depth = np.minimum(floor, WALL_M)
    cube = np.zeros(depth.shape, np.bool_)
    if cube_m is not None:
        x, y = rays[..., 0] * cube_m, rays[..., 1] * cube_m
        cube = (np.abs(x) <= 0.3) & (y <= EYE_M) & (y >= EYE_M - 0.6) & (depth > cube_m)
        depth = np.where(cube, cube_m, depth)
    observation = Observation(
        rgb=np.zeros((*depth.shape, 3), np.uint8),
        depth=depth.astype(np.float32),
        world_from_camera=Pose.from_yaw(0.0, (0.0, 0.0, EYE_M)) @ BODY_FROM_OPTICAL,
        world_from_base=Pose.from_yaw(0.0, (0.0, 0.0, 0.0)),
        intrinsics=CAMERA,
    )
    return observation, cube


def boxed(*masks: NDArray[np.bool_], label: str = "chair", margin: int = 0) -> Detections:
    """Detections whose masks are the boxes of some masks, widened."""
    boxes, filled = [], np.zeros((len(masks), *masks[0].shape), np.bool_)
    for mask, own in zip(masks, filled, strict=True):
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        box = (max(columns[0] - margin, 0), max(rows[0] - margin, 0))
        boxes.append((*box, columns[-1] + 1 + margin, rows[-1] + 1 + margin))
        own[box[1] : boxes[-1][3], box[0] : boxes[-1][2]] = True
    scores = np.ones(len(masks), np.float32)
    corners = np.array(boxes, np.float32)
    return Detections((label,) * len(masks), scores, corners, filled, masks_are_boxes=True)


@pytest.mark.parametrize("margin", [0, 8])
def test_the_cube_in_a_box_is_told_from_wall_and_floor(margin: int) -> None:
    observation, cube = room(cube_m=2.0)
    seen = object_masks(observation, boxed(cube, margin=margin))
    [mask] = seen.masks
    assert not seen.masks_are_boxes
    assert not (mask & ~cube).any()
    assert np.count_nonzero(mask) > 0.7 * np.count_nonzero(cube)


def test_masks_that_are_no_boxes_are_left_alone() -> None:
    observation, cube = room(cube_m=2.0)
    exact = Detections(("chair",), np.ones(1, np.float32), np.zeros((1, 4), np.float32), cube[None])
    assert object_masks(observation, exact) is exact
    nothing = Detections.empty(*observation.depth.shape)
    assert object_masks(observation, nothing) is nothing


def test_a_box_without_depth_stays_a_box() -> None:
    observation, cube = room(cube_m=2.0)
    blind = Observation(
        observation.rgb,
        np.zeros_like(observation.depth),
        observation.world_from_camera,
        observation.world_from_base,
        CAMERA,
    )
    detections = boxed(cube)
    assert (object_masks(blind, detections).masks == detections.masks).all()


def test_boxes_round_true_objects_give_most_of_them_back() -> None:
    """Against ground truth, in a furnished house: how much of a mask is the object, over all."""
    env = small_runner().env
    env.reset(seed=0, options={"target": "toilet"})
    oracle = OracleDetector(env.oracle)
    right = taken = true = 0
    for _ in range(12):
        observation = env.observe()
        seen = oracle.detect(observation.rgb, ("chair", "sofa", "table", "bed", "toilet"))
        for mask, label in zip(seen.masks, seen.labels, strict=True):
            measured = mask & (observation.depth > 0.0)
            if np.count_nonzero(measured) < 100:
                continue
            [own] = object_masks(observation, boxed(mask, label=label)).masks
            right += np.count_nonzero(own & mask)
            taken += np.count_nonzero(own)
            true += np.count_nonzero(measured)
        env.step(int(Action.TURN_LEFT))
    assert right / taken > 0.8
    assert right / true > 0.5


def test_what_stands_before_the_middle_of_a_wide_thing_is_not_it() -> None:
    """A coffee table fills the middle of the sofa's box, but not the box."""
    observation, _ = room()
    depth = observation.depth.copy()
    sofa, table = np.zeros_like(depth, np.bool_), np.zeros_like(depth, np.bool_)
    sofa[52:84, 40:120], table[64:84, 54:106] = True, True
    depth[sofa] = 3.0
    depth[table] = 2.0
    hidden = Observation(
        observation.rgb,
        depth,
        observation.world_from_camera,
        observation.world_from_base,
        CAMERA,
    )
    [mask] = object_masks(hidden, boxed(sofa, label="sofa")).masks
    assert not (mask & table).any()
    assert np.count_nonzero(mask) > 0.5 * np.count_nonzero(sofa & ~table)


def before_the_wall(depth_of_thing: NDArray[np.float64], thing: NDArray[np.bool_]) -> Observation:
    """The room's wall, with a thing of so much depth before it."""
    observation, _ = room()
    depth = np.where(thing, depth_of_thing, observation.depth).astype(np.float32)
    return replace(observation, depth=depth)


def rectangle(rows: slice, columns: slice) -> NDArray[np.bool_]:
    """Pixels of a part of the image."""
    mask = np.zeros((CAMERA.height, CAMERA.width), np.bool_)
    mask[rows, columns] = True
    return mask


def test_the_wall_that_a_thing_touches_is_not_part_of_it() -> None:
    thing = rectangle(slice(40, 72), slice(80, 110))
    # As smooth a surface as a wall's: from the wall it comes forth by 3 cm a column.
    slanting = WALL_M - 0.03 * (np.arange(CAMERA.width)[None, :] - 79.0) + np.zeros(thing.shape)
    box = rectangle(slice(40, 72), slice(30, 110))  # most of it shows the wall
    [mask] = object_masks(before_the_wall(slanting, thing), boxed(box, label="toilet")).masks
    assert np.count_nonzero(mask & thing) > 0.7 * np.count_nonzero(thing)
    assert np.count_nonzero(mask & ~thing) == 0


def test_leaves_are_told_from_the_wall_between_them() -> None:
    row, column = np.mgrid[: CAMERA.height, : CAMERA.width]
    bounds = rectangle(slice(30, 70), slice(60, 100))
    leaves = bounds & (row % 8 < 4) & (column % 8 < 4)
    observation = before_the_wall(np.full(leaves.shape, WALL_M - 0.4), leaves)
    [mask] = object_masks(observation, boxed(bounds, label="plant")).masks
    assert np.count_nonzero(mask & leaves) > 0.9 * np.count_nonzero(leaves)
    assert not (mask & ~leaves).any()


def test_what_hangs_on_a_wall_is_not_taken_for_the_wall() -> None:
    observation, _ = room()
    box = rectangle(slice(30, 60), slice(60, 100))
    [screen] = object_masks(observation, boxed(box, label="tv_monitor")).masks
    [flat_chair] = object_masks(observation, boxed(box, label="chair")).masks
    assert np.count_nonzero(screen) > 0.8 * np.count_nonzero(box)
    # Where nothing but the wall is in a box, the wall is all that can be meant.
    np.testing.assert_array_equal(screen, flat_chair)
