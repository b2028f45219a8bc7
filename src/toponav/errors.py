"""Every error that TopoNav raises on purpose.

The message is one line that says what is wrong and how to mend it. Only the command line turns an
error into an exit code: `InputError` and its kind become 2 (bad usage), the others 1 (failed run).
"""

from __future__ import annotations


class TopoNavError(Exception):
    """Base of all errors raised on purpose; the message is fit for a user to read."""


class InputError(TopoNavError):
    """Something that the user passed (a file, an option, a value) cannot be used."""


class ConfigError(InputError):
    """A configuration has an unknown key or an impossible value."""


class PoseError(InputError):
    """A matrix or quaternion is not a rigid transformation."""


class SceneError(InputError):
    """A house file, mesh scene or generator spec is wrong."""


class EpisodeError(InputError):
    """An episode cannot be run in its scene (unknown target, start inside a wall, ...)."""


class RecordingError(InputError):
    """A recording of posed RGB-D frames is incomplete or damaged."""


class ObservationError(InputError):
    """An observation breaks its contract (shapes, types, NaN or infinite depth, ...)."""


class StaleViewError(TopoNavError):
    """A cloud of a map was first looked at after the map had gone on."""


class MissingExtraError(InputError):
    """An optional dependency is not installed; the message names the extra that brings it."""


class ReasonerError(TopoNavError):
    """A reasoner could not give valid guidance."""
