"""Habitat-Sim behind the environment seam; loads only where habitat_sim is installed."""

from toponav.envs.habitat.env import HabitatEnv

__all__ = ["HabitatEnv"]
