"""The page's modules as one script: each in a scope of its own, in the order of their imports.

A page that opens from a file cannot load modules from beside it, so they are put into it. What is
understood is what they use: `import { a, b } from "./name.js";`, and `export` before a function,
class or constant.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([\w-]+)\.js";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?:async )?(?:function|class|const) (\w+)", re.MULTILINE)


def bundle(modules: Mapping[str, str], entry: str) -> str:
    """One strict script that runs `entry` and all that it imports.

    Args:
        modules: Source by name.
        entry: The module that starts the page.
    """
    parts = [_scope(name, modules[name]) for name in _in_order(modules, entry)]
    return '"use strict";\nconst modules = {};\n' + "\n".join(parts)


def _in_order(modules: Mapping[str, str], entry: str) -> list[str]:
    """Every module after those that it imports."""
    order: list[str] = []

    def visit(name: str, importers: tuple[str, ...]) -> None:
        assert name not in importers, f"modules import each other: {(*importers, name)}"
        for _, imported in IMPORT.findall(modules[name]):
            visit(imported, (*importers, name))
        if name not in order:
            order.append(name)

    visit(entry, ())
    return order


def _scope(name: str, source: str) -> str:
    """A module as a function that is called at once; what it exports is kept by its name."""
    body = IMPORT.sub(_imported, source)
    exports = ", ".join(EXPORT.findall(source))
    body = re.sub(r"^export ", "", body, flags=re.MULTILINE)
    return f'modules["{name}"] = (() => {{\n{body}\nreturn {{ {exports} }};\n}})();\n'


def _imported(match: re.Match[str]) -> str:
    names = " ".join(match[1].split())
    return f'const {{ {names} }} = modules["{match[2]}"];\n'
