"""Every name that a scene, a model or a file can bring stays text in the browser."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from chromium import Browser
from explained_runs import explained_run, report_of

from toponav.evaluation.explanation_file import EXPLANATION_FILE
from toponav.evaluation.model_files import episode_name
from toponav.evaluation.tables.runs import load_runs

HOSTILE = (
    "</script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 1'>"
    "</title></style>\"'&amp;<!--${window.hacked = 1}"
)
NO_NAMES = {"format", "panorama", "image"}
"""Of an explanation: what is no text for people."""


def poisoned(value: Any) -> Any:
    """Every text replaced."""
    if isinstance(value, dict):
        return {key: item if key in NO_NAMES else poisoned(item) for key, item in value.items()}
    if isinstance(value, list):
        return [poisoned(item) for item in value]
    return HOSTILE if isinstance(value, str) else value


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("hostile")
    run = explained_run(folder / "run", "generated:6", 1)
    (result,) = load_runs([run])[0].episodes
    own = run / "episodes" / episode_name(result.scene, result.index)
    poison_lines(own / "decisions.jsonl")
    explanation = json.loads(gzip.decompress((own / EXPLANATION_FILE).read_bytes()))
    for decision in explanation["decisions"]:
        decision["exchanges"] = 1
    data = json.dumps(poisoned(explanation)).encode()
    (own / EXPLANATION_FILE).write_bytes(gzip.compress(data))
    own.rename(own.parent / episode_name(HOSTILE, result.index))
    calls = run / "calls" / f"{episode_name(HOSTILE, result.index)}.jsonl"
    calls.parent.mkdir()
    call = dict.fromkeys(("prompt", "model", "text", "answer", "failure"), HOSTILE)
    calls.write_text(json.dumps({**call, "attempts": [{"failure": HOSTILE}]}) + "\n")
    line = json.loads((run / "episodes.jsonl").read_text())
    named = dict.fromkeys(("scene", "target", "method", "ended", "failure"), HOSTILE)
    (run / "episodes.jsonl").write_text(json.dumps({**line, **named}) + "\n")
    poison_config(run / "config.json")
    return report_of(folder / "r.html", run, names=(HOSTILE,))[0]


def poison_lines(path: Path) -> None:
    lines = [json.dumps(poisoned(json.loads(line))) for line in path.read_text().splitlines()]
    path.write_text("\n".join(lines) + "\n")


def poison_config(path: Path) -> None:
    config = json.loads(path.read_text())
    path.write_text(json.dumps({**config, "method": HOSTILE, "detector": HOSTILE}))


def test_the_text_is_hostile(session: Browser, tmp_path: Path) -> None:
    """On a page that escapes nothing it runs: so the tests below can fail."""
    bare = tmp_path / "bare.html"
    bare.write_text(f"<p>{HOSTILE}</p>")
    session.open(bare)
    session.until("return window.hacked === 1")
    session.complaints()


def test_names_stay_text(browser: Browser, page: Path) -> None:
    browser.open(page)
    browser.until("return document.readyState === 'complete'")
    scripts = browser.count("script:not([type])")
    assert scripts == 1
    assert HOSTILE in browser.run("return document.title")
    assert browser.text("#list b") == HOSTILE
    browser.run("document.querySelector('#list a').click()")
    browser.until("return document.querySelectorAll('.fact').length > 3")
    browser.run("document.querySelectorAll('details').forEach((one) => (one.open = true))")
    facts = browser.text(".facts")
    assert facts.count("window.hacked = 1") > 8
    assert HOSTILE in browser.text("blockquote")
    assert HOSTILE in browser.text("pre")
    assert HOSTILE in browser.run("return document.querySelector('.map').textContent")
    while "decision=end" not in browser.run("return location.hash"):
        before = browser.run("return location.hash")
        browser.press("\ue014")
        browser.until("return location.hash !== arguments[0]", before)
    assert HOSTILE in browser.text(".caption")
    assert browser.count("script:not([type])") == scripts
    assert browser.count("img") == 0
    assert browser.run("return window.hacked") is None


def test_a_hostile_address_does_nothing(browser: Browser, page: Path) -> None:
    for part in ("run", "scene", "with", "view", "decision"):
        browser.open(page, f"#{part}=%3Cimg%20src%3Dx%20onerror%3D'window.hacked%3D1'%3E&index=0")
        browser.until("return document.readyState === 'complete'")
        assert browser.run("return window.hacked") is None
        assert browser.count("img") == 0
