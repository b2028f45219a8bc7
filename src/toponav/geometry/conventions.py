"""Axis conventions of other systems, converted at adapters only (docs/conventions.md)."""

from __future__ import annotations

import math

import numpy as np

from toponav.geometry.pose import Pose

BODY_FROM_OPTICAL = Pose.from_rotation(
    np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), np.zeros(3)
)
"""Robot body (x forward, y left, z up; ROS REP 103) from camera (x right, y down, z forward)."""

OPTICAL_FROM_OPENGL = Pose.from_rotation(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
"""Optical camera from an OpenGL one (x right, y up, z backward)."""

WORLD_FROM_HABITAT = Pose.from_rotation(
    np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), np.zeros(3)
)
"""Our world (z up) from Habitat's (y up, -z forward): (x, y, z) -> (x, -z, y)."""

WORLD_FROM_Y_DOWN = Pose.from_rotation(
    np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3)
)
"""Our world (z up) from one whose y axis points down, as a first camera's frame often is."""

HABITAT_FROM_WORLD = WORLD_FROM_HABITAT.inverse()
"""Habitat's world from ours."""


def habitat_rotation(yaw: float) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w) of an upright Habitat agent, facing -z at rest, with our heading."""
    half = 0.5 * (yaw - 0.5 * math.pi)
    return 0.0, math.sin(half), 0.0, math.cos(half)


def yaw_of_habitat(y: float, w: float) -> float:
    """Our heading, radians in [-pi, pi], of a Habitat agent with the quaternion (0, y, 0, w)."""
    return math.remainder(2.0 * math.atan2(y, w) + 0.5 * math.pi, math.tau)
