"""The page: template, style, script and data in one file that asks nobody for anything."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
from collections.abc import Mapping
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any

from toponav.viz.report.script import bundle

ENTRY = "main"


def page(
    title: str, overview: Mapping[str, Any], episodes: Mapping[str, str], images: Mapping[str, str]
) -> bytes:
    """The whole HTML; names of files that are no text are shown with question marks.

    Args:
        title: Of the page.
        overview: What is shown at once.
        episodes: By id, `packed` data that is decoded when an episode is opened.
        images: WebP as base64, by id.
    """
    style, script = _text("style.css"), _script()
    parts = {
        "title": html.escape(title),
        "policy": _policy(style, script),
        "style": style,
        "script": script,
        "overview": _block("overview", "application/json", _safe_json(overview)),
        "data": "\n".join(
            [
                *(_block(key, "application/gzip", text) for key, text in episodes.items()),
                *(_block(f"i-{key}", "image/webp", text) for key, text in images.items()),
            ]
        ),
    }
    head, *rest = _text("page.html").split("{{")
    pieces = [head]
    for part in rest:
        name, text = part.split("}}", 1)
        pieces += [parts[name], text]
    return "".join(pieces).encode("utf-8", errors="replace")


def packed(value: Any) -> str:
    """JSON, gzipped, base64: letters and digits only."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")


def _script() -> str:
    files = sorted(entry.name for entry in _folder().iterdir() if entry.name.endswith(".js"))
    return "\n" + bundle({name.removesuffix(".js"): _text(name) for name in files}, ENTRY)


def _policy(style: str, script: str) -> str:
    """No source of anything but this very style and script and pictures within the page."""
    return (
        f"default-src 'none'; script-src {_digest(script)}; style-src {_digest(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def _block(name: str, kind: str, text: str) -> str:
    """Data that no browser runs."""
    return f'<script type="{kind}" id="{name}">{text}</script>'


def _safe_json(value: Any) -> str:
    """JSON in which nothing ends a script element or begins a comment."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def _text(name: str) -> str:
    text: str = (_folder() / name).read_text(encoding="utf-8")
    return text


def _folder() -> Traversable:
    return resources.files("toponav.viz.report") / "web"
