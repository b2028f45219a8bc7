"""The semantic point cloud map: voxel clouds, the occupancy grid and frontiers (Section III-C).

`view` declares what the rest of the system sees; `semantic_map.SemanticMap` builds it.
"""

from toponav.mapping.view import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    FrameUpdate,
    MapView,
    OccupancyGrid,
    PointCloud,
)

__all__ = [
    "FREE",
    "OCCUPIED",
    "UNKNOWN",
    "FrameUpdate",
    "MapView",
    "OccupancyGrid",
    "PointCloud",
]
