"""The page as a file: what is in it, that it is the same each time, and that it stays small."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html.parser
import json
import re
from pathlib import Path
from typing import Any

import pytest
from explained_runs import explained_run, report_of

from made_results import made_result, missed, write_run
from toponav.errors import InputError
from toponav.evaluation.explanation_file import EXPLANATION_FILE, load_explanation
from toponav.evaluation.model_files import episode_name
from toponav.evaluation.recorder import episode_folder
from toponav.evaluation.tables.runs import load_runs
from toponav.viz.report.episode_files import read_episode
from toponav.viz.report.report import write_report

EPISODES = 2


class Blocks(html.parser.HTMLParser):
    """The scripts of a page as a browser splits them, and its policy."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.data: dict[str, str] = {}
        self.scripts: list[str] = []
        self.styles: list[str] = []
        self.policy = ""
        self.links: list[str] = []
        self._into: Any = None
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.links += [str(values[key]) for key in ("src", "href") if key in values]
        self._into = None
        if tag == "script" and "id" in values:
            self._into = lambda text: self.data.update({str(values["id"]): text})
        elif tag == "script":
            self._into = self.scripts.append
        elif tag == "style":
            self._into = self.styles.append
        elif tag == "meta" and values.get("http-equiv") == "Content-Security-Policy":
            self.policy = str(values["content"])

    def handle_data(self, data: str) -> None:
        if self._into is not None:
            self._into(data)
            self._into = None


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return explained_run(tmp_path_factory.mktemp("runs") / "own", "generated:6", EPISODES)


@pytest.fixture(scope="module")
def blocks(run: Path) -> Blocks:
    path, _ = report_of(run / "report.html", run)
    return Blocks(path.read_text(encoding="utf-8"))


def unpacked(block: str) -> Any:
    return json.loads(gzip.decompress(base64.b64decode(block)))


def test_the_overview_holds_every_episode_and_the_tables(run: Path, blocks: Blocks) -> None:
    overview = json.loads(blocks.data["overview"])
    (own,) = load_runs([run])
    shown = overview["runs"][0]["episodes"]
    assert [(e["scene"], e["index"], e["spl"]) for e in shown] == [
        (e.scene, e.index, e.spl) for e in own.episodes
    ]
    titles = [table["title"] for table in overview["tables"]]
    assert titles[0] == "Runs"
    assert "Runs by category" in titles
    assert "What became of the episodes" in titles
    (row,) = overview["tables"][0]["panels"][0]["rows"]
    assert row[0] == [own.name, ""]
    assert all("[" in interval for _, interval in row[2:6])


def test_an_episode_holds_what_was_recorded(run: Path, blocks: Blocks) -> None:
    (own,) = load_runs([run])
    for k, result in enumerate(own.episodes):
        data = unpacked(blocks.data[f"e-0-{k}"])
        records = read_episode(run, result)
        assert len(data["decisions"]) == len(records.decisions) == result.decisions
        assert len(data["steps"]["x"]) == result.steps
        for shown, line in zip(data["decisions"], records.decisions, strict=True):
            assert shown["step"] == line.step
            assert shown["changes"]
            assert f"i-{shown['panorama']}" in blocks.data


def test_equal_pictures_are_there_once(run: Path, blocks: Blocks, tmp_path: Path) -> None:
    once = {name for name in blocks.data if name.startswith("i-")}
    path, _ = report_of(tmp_path / "twice.html", run, copied(run, tmp_path / "copy"))
    assert {n for n in Blocks(path.read_text()).data if n.startswith("i-")} == once


def copied(run: Path, folder: Path) -> Path:
    for path in run.rglob("*"):
        if path.is_file() and path.suffix != ".html":
            target = folder / path.relative_to(run)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())
    return folder


def test_the_same_run_makes_the_same_page(run: Path, tmp_path: Path) -> None:
    first, _ = report_of(tmp_path / "a.html", run)
    second, _ = report_of(tmp_path / "b.html", run)
    assert first.read_bytes() == second.read_bytes()


def test_the_policy_admits_this_script_and_style_and_no_network(blocks: Blocks) -> None:
    (script,), (style,) = blocks.scripts, blocks.styles
    for text, kind in ((script, "script-src"), (style, "style-src")):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{kind} 'sha256-{digest}';" in blocks.policy
    assert blocks.policy.startswith("default-src 'none';")
    assert "unsafe" not in blocks.policy
    assert "http" not in blocks.policy.replace("http-equiv", "")
    assert all(link.startswith("#") for link in blocks.links)


def test_the_script_makes_elements_of_text_only(blocks: Blocks) -> None:
    (script,) = blocks.scripts
    for way in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(",
                "new Function", "fetch(", "XMLHttpRequest", "DOMParser"):  # fmt: skip
        assert way not in script


def test_nothing_ends_the_overview_early(tmp_path: Path) -> None:
    hostile = "</script><script>alert(1)</script><!--\udcff"  # and a byte that is no text
    folder = write_run(tmp_path / "run", [made_result(scene=hostile), missed(target=hostile)])
    path, _ = report_of(tmp_path / "r.html", folder, names=(hostile,))
    blocks = Blocks(path.read_text(encoding="utf-8"))
    assert len(blocks.scripts) == 1
    overview = json.loads(blocks.data["overview"])
    assert overview["runs"][0]["name"] == hostile
    assert hostile in {e["scene"] for e in overview["runs"][0]["episodes"]}
    assert "<script>alert" not in path.read_text(encoding="utf-8")


def test_pictures_shrink_where_the_page_would_be_too_large(run: Path, tmp_path: Path) -> None:
    full = report_of(tmp_path / "full.html", run)[0].stat().st_size
    pictures = sum(
        len(text)
        for name, text in Blocks((tmp_path / "full.html").read_text()).data.items()
        if name.startswith("i-")
    )
    budget = full - pictures // 3
    write_report(load_runs([run]), tmp_path / "small.html", max_mb=budget / 1e6)
    assert (tmp_path / "small.html").stat().st_size <= budget


def test_a_run_without_explanations_has_paths_and_places(tmp_path: Path) -> None:
    run = explained_run(tmp_path / "bare", "generated:6", 1, explain=False)
    path, (own,) = report_of(tmp_path / "r.html", run)
    data = unpacked(Blocks(path.read_text()).data["e-0-0"])
    assert len(data["steps"]["x"]) == own.episodes[0].steps
    assert data["memory"]["nodes"]
    assert "map" not in data["decisions"][0]


def test_a_run_without_any_record_has_its_tables(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", [made_result(), missed(index=1)])
    path, _ = report_of(tmp_path / "r.html", folder)
    assert unpacked(Blocks(path.read_text()).data["e-0-1"])["decisions"] == []


def test_damaged_records_are_named(run: Path, tmp_path: Path) -> None:
    folder = copied(run, tmp_path / "run")
    (own,) = load_runs([folder])
    episode = episode_folder(folder, own.episodes[0].scene, own.episodes[0].index)
    decisions = episode / "decisions.jsonl"
    whole = decisions.read_text()
    decisions.write_text('{"index": 0, "step": "x", "phase": "exploration"}\n')
    with pytest.raises(InputError, match=r"decisions\.jsonl, line 1: step"):
        read_episode(folder, own.episodes[0])
    decisions.write_text(whole + '{"index": 9, "st')  # torn by a kill
    assert len(read_episode(folder, own.episodes[0]).decisions) == own.episodes[0].decisions
    explanation = episode / EXPLANATION_FILE
    data = load_explanation(explanation).model_dump()
    data["decisions"][0]["panorama"] = "bm8gcGljdHVyZSBhdCBhbGw="
    explanation.write_bytes(gzip.compress(json.dumps(data).encode()))
    with pytest.raises(InputError, match="a picture is damaged"):
        report_of(tmp_path / "r.html", folder)


def test_what_a_model_was_asked_stands_with_its_decision(run: Path, tmp_path: Path) -> None:
    folder = copied(run, tmp_path / "run")
    (own,) = load_runs([folder])
    result = own.episodes[0]
    explanation = episode_folder(folder, result.scene, result.index) / EXPLANATION_FILE
    data = load_explanation(explanation).model_dump()
    for k, decision in enumerate(data["decisions"]):
        decision["exchanges"] = k + 1 if k else 2
    explanation.write_bytes(gzip.compress(json.dumps(data).encode()))
    calls = folder / "calls" / f"{episode_name(result.scene, result.index)}.jsonl"
    calls.parent.mkdir()
    asked = [{"prompt": "guidance", "model": "m", "text": f"question {k}", "answer": "{}"}
             for k in range(3)]  # fmt: skip
    calls.write_text("".join(json.dumps(line) + "\n" for line in asked))
    path, _ = report_of(tmp_path / "r.html", folder)
    decisions = unpacked(Blocks(path.read_text()).data["e-0-0"])["decisions"]
    told = [[e["text"] for e in decision["exchanges"]] for decision in decisions]
    assert told[:3] == [["question 0", "question 1"], [], ["question 2"]]


def test_the_modules_are_all_on_the_page(blocks: Blocks) -> None:
    names = re.findall(r'^modules\["([\w-]+)"\] = ', blocks.scripts[0], flags=re.MULTILINE)
    web = Path(__file__).parents[3] / "src" / "toponav" / "viz" / "report" / "web"
    assert sorted(names) == sorted(path.stem for path in web.glob("*.js"))
    assert names[-1] == "main"
