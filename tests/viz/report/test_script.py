"""Modules become one script, in order, each with its own names."""

from __future__ import annotations

import pytest

from toponav.viz.report.script import bundle

ENTRY = (
    'import { twice } from "./sums.js";\nimport {\n  NAME,\n} from "./names.js";\ntwice(NAME);\n'
)
SUMS = 'import { NAME } from "./names.js";\nconst own = NAME;\nexport function twice(x) {}\n'
NAMES = "export const NAME = 1;\nexport class Thing {}\nexport async function later() {}\n"
MODULES = {"main": ENTRY, "sums": SUMS, "names": NAMES, "unused": "export const X = 1;\n"}


def test_a_module_comes_after_what_it_imports_and_once() -> None:
    text = bundle(MODULES, "main")
    order = [text.index(f'modules["{name}"] = ') for name in ("names", "sums", "main")]
    assert order == sorted(order)
    assert text.count('modules["names"] = ') == 1
    assert "unused" not in text


def test_imports_and_exports_become_local_names() -> None:
    text = bundle(MODULES, "main")
    assert 'const { NAME } = modules["names"];' in text
    assert 'const { NAME, } = modules["names"];' in text
    assert "return { NAME, Thing, later };" in text
    assert "return { twice };" in text
    for word in ("import ", "export "):
        assert word not in text


def test_modules_that_import_each_other_are_refused() -> None:
    circle = {"a": 'import { b } from "./b.js";\n', "b": 'import { a } from "./a.js";\n'}
    with pytest.raises(AssertionError, match="import each other"):
        bundle(circle, "a")
