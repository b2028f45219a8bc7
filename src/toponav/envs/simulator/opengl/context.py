"""OpenGL without a display: a context through EGL, one for each thread that renders."""

from __future__ import annotations

import ctypes
import os
import threading
from typing import Any

from toponav.errors import InputError, MissingExtraError

LIBEGL, LIBGL = "libEGL.so.1", "libGL.so.1"

DEVICE_VARIABLE = "TOPONAV_GL_DEVICE"
"""Names one of EGL's devices by its index; without it the first that works is taken. Mesa's
software renderer is the last one, and the only one of a machine without a GPU."""

MOST_DEVICES = 16

REQUIRED_VERSION = 330

GL_COLOR = 0x1800

_of_thread = threading.local()


class _Process:
    """Which process has started OpenGL: its driver's threads do not survive a fork."""

    started: int | None = None


def thread_context() -> Any:
    """This thread's moderngl context, created when it is first asked for.

    Raises:
        MissingExtraError: moderngl is not installed, or EGL gives no context.
        InputError: This process was forked from one that had started OpenGL, or the environment
            names no device.
    """
    if _Process.started not in (None, os.getpid()):
        raise InputError(
            "OpenGL was started before this process was forked: fork earlier, spawn workers "
            "instead, or take another renderer than gl"
        )
    if getattr(_of_thread, "context", None) is None:
        _of_thread.context = _create(import_moderngl())
        _Process.started = os.getpid()
    return _of_thread.context


# moderngl has no names for the following two.


def start_drawing() -> None:
    """Let the device begin with what has been asked for so far, and go on asking.

    Mesa's software renderer collects triangles until then.
    """
    ctypes.CDLL(LIBGL).glFlush()


def fill_integers(attachment: int, value: int) -> None:
    """Set all pixels of an integer image of the framebuffer in use, which a clear does not."""
    ctypes.CDLL(LIBGL).glClearBufferiv(GL_COLOR, attachment, ctypes.byref(ctypes.c_int(value)))


def import_moderngl() -> Any:
    """The module moderngl.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import moderngl
    except ImportError as error:
        raise MissingExtraError(_advice("needs moderngl")) from error
    return moderngl


def _create(moderngl: Any) -> Any:
    """A context on the device that the environment names, or on the first that gives one."""
    failure: Exception | None = None
    for device in _devices():
        try:
            context = moderngl.create_context(
                require=REQUIRED_VERSION,
                standalone=True,
                backend="egl",
                libegl=LIBEGL,
                libgl=LIBGL,
                device_index=device,
            )
        except Exception as error:  # glcontext raises nothing more special
            failure = failure or error
            continue
        context.gc_mode = "context_gc"  # what a scene held is freed in its own thread
        return context
    raise MissingExtraError(_advice(f"gets no OpenGL 3.3 from EGL ({failure})")) from failure


def _devices() -> range:
    named = os.environ.get(DEVICE_VARIABLE, "")
    if not named:
        return range(MOST_DEVICES)
    if not named.isdecimal():
        raise InputError(f"{DEVICE_VARIABLE} takes the index of an EGL device, not {named!r}")
    return range(int(named), int(named) + 1)


def _advice(problem: str) -> str:
    return (
        f"the renderer gl {problem}: pip install 'toponav[gl]' and, on Debian, apt-get install "
        "libegl1 libgl1 libgl1-mesa-dri; or take another renderer"
    )
