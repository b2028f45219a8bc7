"""Image messages of every encoding become the same pictures."""

from __future__ import annotations

import io
import struct

import numpy as np
import pytest
from PIL import Image

from toponav.errors import ObservationError
from toponav.robot.images import colour_image, compressed_depth_image, depth_image


def padded(rows: np.ndarray) -> tuple[int, bytes]:
    """Rows with three bytes of padding each, as some drivers send them."""
    raw = rows.reshape(len(rows), -1).view(np.uint8)
    return raw.shape[1] + 3, np.pad(raw, ((0, 0), (0, 3)), constant_values=255).tobytes()


def test_rgb_and_bgr_give_the_same_image() -> None:
    rgb = np.random.default_rng(0).integers(0, 256, (4, 5, 3), np.uint8)
    np.testing.assert_array_equal(colour_image("rgb8", (4, 5), *padded(rgb)), rgb)
    swapped = np.ascontiguousarray(rgb[..., ::-1])
    np.testing.assert_array_equal(colour_image("bgr8", (4, 5), *padded(swapped)), rgb)


def test_depth_in_millimetres_and_metres_agree_and_holes_are_zero() -> None:
    millimetres = np.array([[0, 1500], [65535, 2]], np.uint16)
    expected = millimetres * np.float32(0.001)
    np.testing.assert_allclose(depth_image("16UC1", (2, 2), *padded(millimetres)), expected)
    metres = np.array([[np.nan, 1.5], [np.inf, -1.0]], np.float32)
    depth = depth_image("32FC1", (2, 2), *padded(metres))
    np.testing.assert_array_equal(depth, np.array([[0, 1.5], [0, 0]], np.float32))


@pytest.mark.parametrize("encoding", ["mono8", "yuyv"])
def test_other_encodings_are_named(encoding) -> None:
    with pytest.raises(ObservationError, match=encoding):
        colour_image(encoding, (1, 1), 3, b"abc")


def test_a_short_message_is_an_error() -> None:
    with pytest.raises(ObservationError, match="bytes"):
        depth_image("16UC1", (2, 2), 4, b"1234567")


def packed(encoding: str, coded: np.ndarray, scale: float = 0.0, offset: float = 0.0) -> tuple:
    """Format and bytes of a compressedDepth message, as image_transport's plugin lays them out."""
    file = io.BytesIO()
    Image.fromarray(coded.astype(np.uint16)).save(file, "PNG")
    return f"{encoding}; compressedDepth png", struct.pack(
        "<iff", 0, scale, offset
    ) + file.getvalue()


def test_packed_depth_in_millimetres_comes_back_exactly() -> None:
    millimetres = np.array([[0, 1500, 65535]], np.uint16)
    depth = compressed_depth_image(*packed("16UC1", millimetres))
    np.testing.assert_array_equal(depth, millimetres * np.float32(0.001))


def test_packed_depth_in_metres_is_as_exact_as_its_inverse_was_coded() -> None:
    metres = np.array([[0.5, 1.0, 4.0, 9.0]])
    scale, offset = 100.0 * 101.0, 1.0 - 100.0 * 101.0 / 10.0  # of the plugin, for 10 m
    coded = np.round(scale / metres + offset)
    depth = compressed_depth_image(*packed("32FC1", np.append(coded, [[0]], 1), scale, offset))
    np.testing.assert_allclose(depth[0, :4], metres[0], rtol=0.01)
    assert depth[0, 4] == 0.0


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        ("16UC1; compressedDepth rvl", b""),
        ("mono8; compressedDepth png", b""),
        ("16UC1; compressedDepth png", b"short"),
    ],
)
def test_packed_depth_of_another_kind_or_damaged_is_an_error(kind, data) -> None:
    with pytest.raises(ObservationError, match="compressed depth"):
        compressed_depth_image(kind, data)
