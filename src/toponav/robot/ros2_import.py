"""The one guard of the extra `ros2`."""

from __future__ import annotations

import importlib
from typing import Any

from toponav.errors import MissingExtraError


def import_ros(module: str) -> Any:
    """A module of ROS 2, from the extra or from a system installation.

    Raises:
        MissingExtraError: There is none.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"{module} is missing: pip install 'toponav[ros2]', or source the setup file of your "
            "ROS 2 installation"
        ) from error
