"""glTF files whose textures are Basis-compressed (KHR_texture_basisu), as HM3D's are.

The images are transcoded to plain pixels and put into the file's bytes, for a reader that knows
PNG only.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from PIL import Image

from toponav.errors import MissingExtraError, SceneError
from toponav.scenes.glb_container import glb_bytes, glb_chunks, glb_description

EXTENSION = "KHR_texture_basisu"


def uses_basis(path: Path) -> bool:
    """Whether a `.glb` says that it needs Basis textures; False for what is no binary glTF."""
    return EXTENSION.encode() in glb_description(path.read_bytes())


def without_basis(path: Path) -> bytes:
    """The file with every Basis texture replaced by a PNG.

    Raises:
        MissingExtraError: No decoder is installed.
        SceneError: The file or a texture in it is damaged.
    """
    decoder = _import_decoder(path)
    try:
        content, data = glb_chunks(path.read_bytes())
        decoded: set[int] = set()
        for texture in content.get("textures", []):
            source = texture.get("extensions", {}).get(EXTENSION, {}).get("source")
            if source is None:
                continue
            if source not in decoded:
                decoded.add(source)
                data = _with_png(content, data, source, decoder)
            del texture["extensions"][EXTENSION]
            texture["source"] = source
    except (LookupError, ValueError, SceneError, decoder.BasisuError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SceneError(f"{path}: damaged or incomplete: {reason}") from error
    for key in ("extensionsUsed", "extensionsRequired"):
        if key in content:
            content[key] = [name for name in content[key] if name != EXTENSION]
    return glb_bytes(content, data)


def _with_png(content: dict[str, Any], data: bytes, source: int, decoder: Any) -> bytes:
    """The binary chunk with an image's PNG at its end; the image then refers to it."""
    image = content["images"][source]
    view = content["bufferViews"][image["bufferView"]]
    start = view.get("byteOffset", 0)
    texture = decoder.open(data[start : start + view["byteLength"]])
    pixels = texture.transcode("rgba8", level=0).data
    stream = io.BytesIO()
    Image.fromarray(pixels[..., :3].copy()).save(stream, "PNG", compress_level=1)
    png = stream.getvalue()
    data += b"\0" * (-len(data) % 4)
    content["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(png)})
    image["bufferView"], image["mimeType"] = len(content["bufferViews"]) - 1, "image/png"
    content["buffers"][0]["byteLength"] = len(data) + len(png)
    return data + png


def _import_decoder(path: Path) -> Any:
    try:
        import opengl_basisu
    except ImportError as error:
        raise MissingExtraError(
            f"{path}: its textures are Basis-compressed; pip install 'toponav[habitat]' brings a "
            "decoder"
        ) from error
    return opengl_basisu
