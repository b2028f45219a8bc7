"""The embedded simulator: posed RGB-D images, exact motion and geodesics in any triangle scene."""

from toponav.envs.simulator.env import HouseEnv, HouseEnvConfig

__all__ = ["HouseEnv", "HouseEnvConfig"]
