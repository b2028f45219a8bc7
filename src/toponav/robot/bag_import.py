"""The one guard of the extra `bags`."""

from __future__ import annotations

import importlib
from typing import Any

from toponav.errors import MissingExtraError


def import_bags(module: str) -> Any:
    """A module of `rosbags`, which reads and writes bags without ROS.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            "rosbags is missing, which reads and writes bags: pip install 'toponav[bags]'"
        ) from error
