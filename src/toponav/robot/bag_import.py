"""The one guard of the extra `bags`."""

from __future__ import annotations

import importlib
from typing import Any

from toponav.errors import MissingExtraError

TRANSFORM_TYPE = "tf2_msgs/msg/TFMessage"
TRANSFORM_DEFINITION = "geometry_msgs/TransformStamped[] transforms"


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


def message_types() -> Any:
    """The store of ROS 2's standard messages, with the one of /tf that it lacks.

    Raises:
        MissingExtraError: rosbags is not installed.
    """
    typesys = import_bags("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_KILTED)
    store.register(typesys.get_types_from_msg(TRANSFORM_DEFINITION, TRANSFORM_TYPE))
    return store
