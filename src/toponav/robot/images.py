"""Image messages as arrays: the encodings that RGB-D cameras publish."""

from __future__ import annotations

import io
import struct

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from toponav.errors import ObservationError

COLOUR_ENCODINGS = ("rgb8", "bgr8")
PIXEL_BYTES = {"rgb8": 3, "bgr8": 3, "16UC1": 2, "32FC1": 4, "32SC1": 4}
MILLIMETRE = 0.001

DEPTH_HEADER_BYTES = 12
"""Of the transport compressedDepth, before the PNG file."""

PNG_TRANSPORTS = (["compressedDepth"], ["png"])
"""Last word of the format of a PNG file: older publishers do not name it."""

Buffer = bytes
"""Anything that holds bytes: rclpy has array.array, a bag's reader NumPy's arrays."""


def colour_image(
    encoding: str, size: tuple[int, int], row_bytes: int, data: Buffer
) -> NDArray[np.uint8]:
    """(H, W, 3) RGB from a message's bytes; `size` is (H, W).

    Raises:
        ObservationError: Another encoding, or too few bytes.
    """
    if encoding not in COLOUR_ENCODINGS:
        raise ObservationError(f"colour images are rgb8 or bgr8, not {encoding!r}")
    rows = _rows(encoding, size, row_bytes, data)
    pixels = rows.reshape(*size, 3)
    return np.ascontiguousarray(pixels[..., ::-1] if encoding == "bgr8" else pixels)


def depth_image(
    encoding: str, size: tuple[int, int], row_bytes: int, data: Buffer
) -> NDArray[np.float32]:
    """(H, W) metres from a message's bytes; holes, NaN and infinity become 0, no return.

    Raises:
        ObservationError: Another encoding, or too few bytes.
    """
    if encoding not in ("16UC1", "32FC1"):
        raise ObservationError(f"depth images are 16UC1 or 32FC1, not {encoding!r}")
    rows = np.ascontiguousarray(_rows(encoding, size, row_bytes, data))
    if encoding == "16UC1":
        return (rows.view("<u2") * MILLIMETRE).astype(np.float32)
    depth = rows.view("<f4").astype(np.float32)
    depth[~(np.isfinite(depth) & (depth > 0.0))] = 0.0
    return depth


def label_image(
    encoding: str, size: tuple[int, int], row_bytes: int, data: Buffer
) -> NDArray[np.int32]:
    """(H, W) indices from a message's bytes.

    Raises:
        ObservationError: Another encoding, or too few bytes.
    """
    if encoding != "32SC1":
        raise ObservationError(f"label images are 32SC1, not {encoding!r}")
    rows = np.ascontiguousarray(_rows(encoding, size, row_bytes, data))
    return rows.view("<i4").astype(np.int32)


def compressed_image(data: Buffer) -> NDArray[np.uint8]:
    """(H, W, 3) RGB from the bytes of a JPEG or PNG file.

    Raises:
        ObservationError: They are no image.
    """
    try:
        with Image.open(io.BytesIO(bytes(data))) as image:
            return np.asarray(image.convert("RGB"))
    except (OSError, UnidentifiedImageError) as error:
        raise ObservationError(f"a compressed image cannot be read: {error}") from error


def compressed_depth_image(kind: str, data: Buffer) -> NDArray[np.float32]:
    """(H, W) metres from a message of the transport compressedDepth; holes are 0.

    Its bytes are a header of 12 and a PNG file of 16 bits: of millimetres, or, where the image was
    in metres, of inverse depths that the header's two numbers scale.

    Args:
        kind: The message's format, such as "16UC1; compressedDepth png".
        data: The message's bytes.

    Raises:
        ObservationError: Another format, or they are no image.
    """
    encoding, _, transport = kind.partition(";")
    if encoding not in ("16UC1", "32FC1") or transport.split()[-1:] not in PNG_TRANSPORTS:
        raise ObservationError(f"compressed depth is 16UC1 or 32FC1 as PNG, not {kind!r}")
    raw = bytes(data)
    try:
        _, scale, offset = struct.unpack_from("<iff", raw)
        with Image.open(io.BytesIO(raw[DEPTH_HEADER_BYTES:])) as image:
            coded = np.asarray(image).astype(np.float32)
    except (OSError, UnidentifiedImageError, struct.error) as error:
        raise ObservationError(f"a compressed depth image cannot be read: {error}") from error
    if encoding == "16UC1":
        return coded * np.float32(MILLIMETRE)
    depth = np.zeros_like(coded)
    np.divide(np.float32(scale), coded - np.float32(offset), out=depth, where=coded > 0.0)
    return depth


def _rows(encoding: str, size: tuple[int, int], row_bytes: int, data: Buffer) -> NDArray[np.uint8]:
    """(H, bytes a row) without the padding at the rows' ends."""
    height, width = size
    used = width * PIXEL_BYTES[encoding]
    if row_bytes < used or memoryview(data).nbytes < height * row_bytes:
        raise ObservationError(
            f"a {encoding} image of {width} x {height} needs {used} bytes a row, not {row_bytes} "
            f"and {len(data)} in all"
        )
    return np.frombuffer(data, np.uint8, height * row_bytes).reshape(height, row_bytes)[:, :used]
