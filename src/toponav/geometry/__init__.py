"""Rigid poses, pinhole cameras and the conversions between axis conventions.

World frames are right-handed with z up, in metres; cameras are optical (x right, y down, z
forward). Imports nothing of TopoNav but its errors.
"""

from toponav.geometry.camera import Intrinsics, back_project, project
from toponav.geometry.pose import Pose

__all__ = ["Intrinsics", "Pose", "back_project", "project"]
