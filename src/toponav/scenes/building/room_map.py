"""Which room of a level lies at a point or in front of a wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon, STRtree, get_coordinates, intersection, linestrings
from shapely import points as shapely_points

NO_ROOM = -1

_PROBE_M = 0.02
"""What lies this far in front of a wall's face is what the face belongs to."""

_SHORTEST_M = 1e-3
"""Faces are not divided into pieces shorter than this."""


class RoomMap:
    """Looks up rooms by place; where rooms overlap, the first one counts."""

    def __init__(self, rooms: Sequence[Polygon]) -> None:
        """Index the rooms of a level, in the order of its list."""
        self._areas = STRtree(rooms)
        self._outlines = STRtree([room.exterior for room in rooms])

    def rooms_at(self, places: NDArray[np.float64]) -> NDArray[np.int64]:
        """(N,) indices of the rooms at (N, 2) places, NO_ROOM outside of all."""
        found = np.full(len(places), NO_ROOM, np.int64)
        place, room = self._areas.query(shapely_points(places), predicate="intersects")
        order = np.lexsort((room, place))[::-1]
        found[place[order]] = room[order]
        return found

    def faces(self, edges: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Divide wall faces where the rooms in front of them change.

        Args:
            edges: (E, 2, 2) directed edges of walls, which are on their left.

        Returns:
            (E', 2, 2) edges and (E',) the room that each faces, NO_ROOM for none.
        """
        if not len(edges):
            return edges, np.zeros(0, np.int64)
        direction = edges[:, 1] - edges[:, 0]
        length = np.linalg.norm(direction, axis=1)
        outward = np.stack([direction[:, 1], -direction[:, 0]], axis=1) / length[:, None]
        probes = edges + _PROBE_M * outward[:, None, :]
        lines = linestrings(probes)
        cuts: dict[int, list[float]] = {}
        for edge, outline in zip(*self._outlines.query(lines, predicate="intersects"), strict=True):
            meeting = intersection(lines[edge], self._outlines.geometries[outline])
            along = direction[edge] / length[edge]
            offsets = (get_coordinates(meeting) - probes[edge, 0]) @ along
            cuts.setdefault(int(edge), []).extend(offsets.tolist())
        pieces = []
        for edge in range(len(edges)):
            pieces += _divided(edges[edge], float(length[edge]), cuts.get(edge, []))
        divided = np.array(pieces)
        direction = divided[:, 1] - divided[:, 0]
        outward = np.stack([direction[:, 1], -direction[:, 0]], axis=1)
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        return divided, self.rooms_at(divided.mean(axis=1) + _PROBE_M * outward)


def _divided(
    edge: NDArray[np.float64], length: float, cuts: Sequence[float]
) -> list[NDArray[np.float64]]:
    """An edge in pieces, cut at distances from its start."""
    stops = [0.0]
    for cut in sorted(cuts):
        if cut - stops[-1] > _SHORTEST_M and length - cut > _SHORTEST_M:
            stops.append(cut)
    stops.append(length)
    ends = edge[0] + np.array(stops)[:, None] / length * (edge[1] - edge[0])
    ends[-1] = edge[1]
    return [ends[i : i + 2] for i in range(len(stops) - 1)]
