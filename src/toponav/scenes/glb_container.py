"""The container of binary glTF: a JSON chunk and a binary one."""

from __future__ import annotations

import json
import struct
from typing import Any

from toponav.errors import SceneError

_HEADER, _CHUNK = struct.Struct("<4sII"), struct.Struct("<II")
_MAGIC, _VERSION = b"glTF", 2
_JSON, _BIN = 0x4E4F534A, 0x004E4942


def glb_bytes(content: dict[str, Any], data: bytes) -> bytes:
    """A `.glb` of a glTF description and its only buffer; chunks are padded to four bytes."""
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = _CHUNK.pack(len(text), _JSON) + text + _CHUNK.pack(len(data), _BIN) + data
    return _HEADER.pack(_MAGIC, _VERSION, _HEADER.size + len(chunks)) + chunks


def glb_chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The glTF description and the buffer of a `.glb`.

    Raises:
        SceneError: Not binary glTF, or cut short.
    """
    try:
        magic, _, _ = _HEADER.unpack_from(data)
        length, kind = _CHUNK.unpack_from(data, _HEADER.size)
        start = _HEADER.size + _CHUNK.size
        content = json.loads(data[start : start + length])
        size, _ = _CHUNK.unpack_from(data, start + length)
    except (struct.error, ValueError) as error:
        raise SceneError("not binary glTF, or cut short") from error
    if magic != _MAGIC or kind != _JSON or not isinstance(content, dict):
        raise SceneError("not binary glTF")
    first = start + length + _CHUNK.size
    return content, data[first : first + size]


def glb_description(head: bytes) -> bytes:
    """The JSON text of a `.glb`, of which `head` are the first bytes; empty for another file."""
    if len(head) < _HEADER.size + _CHUNK.size or not head.startswith(_MAGIC):
        return b""
    length, kind = _CHUNK.unpack_from(head, _HEADER.size)
    start = _HEADER.size + _CHUNK.size
    return head[start : start + length] if kind == _JSON else b""
