"""The page of names says what the table of names holds."""

from __future__ import annotations

import runpy

from docs_commands import ROOT


def test_the_page_is_the_table() -> None:
    script = runpy.run_path(str(ROOT / "docs" / "make_vocabulary_page.py"))
    said = script["PAGE"].read_text(encoding="utf-8")
    assert said == script["page"](), "run python docs/make_vocabulary_page.py"
