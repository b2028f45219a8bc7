"""The frontiers that can be walked to, on drawn maps."""

from __future__ import annotations

import numpy as np

from drawn_map import clusters_from, drawn_map, reach_from
from toponav.control.frontier_clusters import frontier_clusters

ROOM = drawn_map(
    "#########",
    "#.......#",
    " .......#",
    "#.......#",
    "#....... ",
    "#.......#",
    "#########",
    enlarged=5,
)
"""A room of 3.5 m by 2.5 m with a way out on either side."""
HERE = (2.2, 1.5)


def test_each_gap_is_a_cluster_with_the_cheapest_cell_as_its_waypoint() -> None:
    clusters, reach = clusters_from(ROOM, HERE), reach_from(ROOM, HERE)
    assert [cluster.size for cluster in clusters] == [5, 5]
    for cluster in clusters:
        cost = reach.at(cluster.cells)
        np.testing.assert_array_equal(cluster.nearest[:2], cluster.cells[np.argmin(cost)])
        assert cluster.path_cost == cost.min()
        np.testing.assert_array_equal(cluster.reachable, np.isfinite(cost))
    left, right = clusters
    np.testing.assert_allclose(left.centroid, (0.55, 1.25))
    np.testing.assert_allclose(right.centroid, (3.95, 2.25))


def test_cells_that_are_ruled_out_are_no_waypoints_and_a_cluster_without_any_is_dropped() -> None:
    reach = reach_from(ROOM, HERE)
    right_gap = ROOM.frontiers[:, 0] > 2.0
    (left,) = frontier_clusters(ROOM, reach, ~right_gap)
    assert left.nearest[0] < 2.0
    lower = ~right_gap | (ROOM.frontiers[:, 1] < 2.2)
    _, cut = frontier_clusters(ROOM, reach, lower)
    assert cut.size == 5
    in_reach = np.isfinite(reach.at(cut.cells))
    assert 0 < cut.reachable.sum() < in_reach.sum()
    np.testing.assert_array_equal(cut.reachable, in_reach & (cut.cells[:, 1] < 2.2))


def test_what_lies_behind_a_wall_is_no_candidate_and_without_frontiers_there_are_none() -> None:
    split = drawn_map(
        "#######",
        " ..#.. ",
        "#..#..#",
        "#######",
        enlarged=5,
    )  # fmt: skip
    (left,) = clusters_from(split, (0.9, 1.0))
    assert left.centroid[0] < 1.5
    closed = drawn_map("####", "#..#", "#..#", "####", enlarged=5)
    assert clusters_from(closed, (1.0, 1.0)) == ()
