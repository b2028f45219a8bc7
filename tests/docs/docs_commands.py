"""The `toponav` commands of the documentation, found where a reader finds them.

A fenced `bash` block is run by the tests, unless the line before it is a marker such as
`<!-- needs: hours -->`; its commands are then only held against the command line's options.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NEEDS = frozenset(
    {"data", "display", "habitat", "hours", "model", "cluster", "open3d", "opengl", "ros2"}
)
"""What a marker may name: data or a program that is not in the repository, or much time."""

BLOCK = re.compile(r"^(?:<!-- needs: (?P<needs>\w+) -->\n)?```(?:bash|console)\n(?P<body>.*?)^```",
                   re.MULTILINE | re.DOTALL)  # fmt: skip


@dataclass(frozen=True)
class Block:
    """One fenced block: the page, what it needs, and its commands' arguments."""

    page: str
    needs: str | None
    commands: tuple[tuple[str, ...], ...]


def pages() -> list[Path]:
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks() -> list[Block]:
    found = []
    for page in pages():
        for match in BLOCK.finditer(page.read_text(encoding="utf-8")):
            commands = tuple(commands_of(match["body"]))
            if commands:
                found.append(Block(str(page.relative_to(ROOT)), match["needs"], commands))
    return found


def commands_in_tables() -> list[tuple[str, ...]]:
    """Those of the README's table of what one can do."""
    rows = [line for line in pages()[0].read_text(encoding="utf-8").splitlines() if line[:1] == "|"]
    quoted = [code for row in rows for code in re.findall(r"`(toponav [^`]+)`", row)]
    return [command for code in quoted for command in commands_of(code)]


def commands_of(body: str) -> list[tuple[str, ...]]:
    """The arguments of each `toponav` of a shell text; a shell's variable stands as 0."""
    commands = []
    for line in re.sub(r"\$\w+", "0", body.replace("\\\n", " ")).splitlines():
        lexer = shlex.shlex(line.removeprefix("$ "), posix=True, punctuation_chars=";&|")
        lexer.whitespace_split = True
        lexer.commenters = "#"
        words: list[str] = []
        for word in [*lexer, ";"]:
            if set(word) <= set(";&|"):
                if words[:1] == ["toponav"]:
                    commands.append(tuple(words[1:]))
                words = []
            else:
                words.append(word)
    return commands
