"""One pass from depth to the clouds: eq. (1), eq. (2) and the height bands of Sec. III-C."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from toponav.mapping.voxels import VoxelStore, insert_point

NO_LABEL = -1


@njit(cache=True)
def integrate_frame(  # noqa: PLR0913, PLR0917  # a kernel: everything it touches is an argument
    depth: NDArray[np.float32],
    rgb: NDArray[np.uint8],
    labels: NDArray[np.int16],
    lens: tuple[float, float, float, float],
    pose: NDArray[np.float64],
    limits: tuple[float, float, float, float],
    navigable_tags: NDArray[np.bool_],
    resolution: float,
    scene: VoxelStore,
    objects: VoxelStore,
    navigable: VoxelStore,
    obstacles: VoxelStore,
    start: int,
) -> int:
    """Back-project pixels in row order and insert them where they belong.

    Args:
        depth: (H, W) metres.
        rgb: (H, W, 3).
        labels: (H, W) class of each pixel, NO_LABEL for none.
        lens: fx, fy, cx, cy.
        pose: (3, 4) upper rows of world_from_camera.
        limits: Largest depth; lowest and highest z of floor; highest z of an obstacle.
        navigable_tags: (n_classes,) whether a class is in C_nav.
        resolution: r_pcd.
        scene: M_scene.
        objects: M_obj, tagged by class.
        navigable: M_nav of the floor.
        obstacles: M_obs of the floor.
        start: Pixel to start from.

    Returns:
        The pixel at which a store ran out of room, or H * W when done.
    """
    height, width = depth.shape
    fx, fy, cx, cy = lens
    max_depth, floor_low, floor_high, obstacle_high = limits
    for pixel in range(start, height * width):
        if (
            scene.header[0] >= len(scene.counts)
            or objects.header[0] >= len(objects.counts)
            or navigable.header[0] >= len(navigable.counts)
            or obstacles.header[0] >= len(obstacles.counts)
        ):
            return pixel
        v, u = pixel // width, pixel % width
        d = float(depth[v, u])
        if d <= 0.0 or d >= max_depth:
            continue
        xc, yc = d * (u - cx) / fx, d * (v - cy) / fy
        x = pose[0, 0] * xc + pose[0, 1] * yc + pose[0, 2] * d + pose[0, 3]
        y = pose[1, 0] * xc + pose[1, 1] * yc + pose[1, 2] * d + pose[1, 3]
        z = pose[2, 0] * xc + pose[2, 1] * yc + pose[2, 2] * d + pose[2, 3]
        point = (x, y, z)
        color = (int(rgb[v, u, 0]), int(rgb[v, u, 1]), int(rgb[v, u, 2]))
        insert_point(scene, point, color, 0, resolution)
        label = labels[v, u]
        if label != NO_LABEL:
            insert_point(objects, point, color, int(label), resolution)
        if (label != NO_LABEL and navigable_tags[label]) or floor_low <= z <= floor_high:
            insert_point(navigable, point, color, 0, resolution)
        elif floor_high < z <= obstacle_high:
            insert_point(obstacles, point, color, 0, resolution)
    return int(height * width)


@njit(cache=True)
def interpolate_to(  # noqa: PLR0913, PLR0917  # a kernel: everything it touches is an argument
    store: VoxelStore,
    standing: tuple[float, float, float],
    points: NDArray[np.float32],
    colors: NDArray[np.uint8],
    step: float,
    band: tuple[float, float],
    resolution: float,
    start: int,
) -> int:
    """Insert p_k = p_stand + k step (x_i - p_stand) / |x_i - p_stand|, k = 1, 2, ... (Sec. III-C).

    Args:
        store: M_nav.
        standing: p_stand.
        points: (N, 3) navigable points x_i of this frame.
        colors: (N, 3) their colours, which the points on the way inherit.
        step: Delta_step.
        band: Lowest and highest z that is kept.
        resolution: r_pcd.
        start: Point to start from.

    Returns:
        The point at which the store ran out of room, or N when done.
    """
    for i in range(start, len(points)):
        dx = points[i, 0] - standing[0]
        dy = points[i, 1] - standing[1]
        dz = points[i, 2] - standing[2]
        color = (int(colors[i, 0]), int(colors[i, 1]), int(colors[i, 2]))
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        count = int(np.floor(length / step))
        if store.header[0] + count > len(store.counts):
            return i
        if length <= step:
            continue
        for k in range(1, count + 1):
            t = k * step / length
            z = standing[2] + t * dz
            if band[0] < z < band[1]:
                point = (standing[0] + t * dx, standing[1] + t * dy, z)
                insert_point(store, point, color, 0, resolution)
    return len(points)
