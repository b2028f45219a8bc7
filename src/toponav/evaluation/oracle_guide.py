"""The guide of `--follower oracle`: shortest paths on the simulator's own navmesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from toponav.envs.simulator import HouseEnv

NEAR_M = 0.5
"""A goal that lies off the navmesh is moved onto it over at most this distance, metres."""


class OracleGuide:
    """Plans with the truth: where the agent is, and where it can walk."""

    def __init__(self, env: HouseEnv) -> None:
        """Take the environment of the running episode."""
        self._env = env

    def path(self, goals: NDArray[np.float64]) -> NDArray[np.float64]:
        """(K, 2) corners from the agent to the nearest of (N, 2) goals; empty without a way."""
        here, surface = self._env.position, self._env.surface
        nearest = goals[np.argsort(np.linalg.norm(goals - here[:2], axis=1), kind="stable")]
        for goal in nearest:
            place = surface.snap(np.array([*goal, here[2]]), NEAR_M)
            if place is not None:
                path = surface.shortest_path(here, place)
                if len(path):
                    return np.asarray(path[:, :2])
        return np.zeros((0, 2))
