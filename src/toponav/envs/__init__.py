"""Environments: importing this registers `toponav/HouseNav-v0` with gymnasium."""

import gymnasium

ENV_ID = "toponav/HouseNav-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(
        id=ENV_ID,
        entry_point="toponav.envs.simulator.env:HouseEnv",
        order_enforce=False,
        disable_env_checker=True,
    )

__all__ = ["ENV_ID"]
