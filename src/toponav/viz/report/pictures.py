"""The pictures of a page: each is there once, and together they fit."""

from __future__ import annotations

import base64
import binascii
import hashlib
import io
import math

from PIL import Image

from toponav.errors import InputError

QUALITY = 70
SMALLEST = 0.25
"""Pictures are not shrunk below this share of their sides: then nothing can be seen on them."""

MARGIN = 0.94
"""Aimed at below the budget: a picture of half the pixels has more than half the bytes."""


class Pictures:
    """WebP pictures by the digest of their content."""

    def __init__(self) -> None:
        """Hold none yet."""
        self._pictures: dict[str, bytes] = {}

    def __len__(self) -> int:
        return len(self._pictures)

    def add(self, text: str, where: str) -> str:
        """Keep a picture, unless it is there already.

        Args:
            text: WebP, base64.
            where: Names its file in messages.

        Returns:
            Its digest.

        Raises:
            InputError: It is no such picture.
        """
        try:
            data = base64.b64decode(text, validate=True)
        except binascii.Error as error:
            raise InputError(f"{where}: a picture is damaged; run the episode again") from error
        if data[:4] != b"RIFF" or data[8:12] != b"WEBP":
            raise InputError(f"{where}: a picture is damaged; run the episode again")
        digest = hashlib.sha256(data).hexdigest()[:16]
        self._pictures[digest] = data
        return digest

    def encoded(self, most_bytes: float) -> dict[str, str]:
        """All pictures as base64, by digest; smaller ones where they would take too much.

        Args:
            most_bytes: What they may take together, as base64.

        Raises:
            InputError: A picture cannot be read.
        """
        scale, pictures = 1.0, self._pictures
        while (total := _encoded_size(pictures)) > most_bytes and scale > SMALLEST:
            scale = max(SMALLEST, scale * min(MARGIN, math.sqrt(max(most_bytes, 0.0) / total)))
            pictures = {digest: _shrunk(data, scale) for digest, data in self._pictures.items()}
        return {
            digest: base64.b64encode(data).decode("ascii")
            for digest, data in sorted(pictures.items())
        }


def _encoded_size(pictures: dict[str, bytes]) -> int:
    return sum(4 * math.ceil(len(data) / 3) for data in pictures.values())


def _shrunk(data: bytes, scale: float) -> bytes:
    try:
        image = Image.open(io.BytesIO(data))
        size = (max(1, round(image.width * scale)), max(1, round(image.height * scale)))
        stream = io.BytesIO()
        image.resize(size).save(stream, "WEBP", quality=QUALITY, method=4)
    except (OSError, ValueError) as error:
        raise InputError(f"a picture of an explanation cannot be read: {error}") from error
    return stream.getvalue()
