"""Every command that a page shows is one that works."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

from docs_commands import NEEDS, ROOT, Block, blocks, commands_in_tables, commands_of, pages
from toponav.cli.main import main, parse
from toponav.config import with_overrides
from toponav.evaluation.run_config import run_config

BLOCKS = blocks()
RUN = [block for block in BLOCKS if block.needs is None]


def test_commands_are_found_whole() -> None:
    body = "toponav demo  # one\ncd x && toponav run a \\\n  --seed 1; toponav table b\nmake test\n"
    assert commands_of(body) == [("demo",), ("run", "a", "--seed", "1"), ("table", "b")]


def test_pages_have_commands_that_are_run() -> None:
    assert {"docs/index.md", "docs/watching.md"} <= {block.page for block in RUN}


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.page)
def test_the_command_line_knows_every_command(block: Block) -> None:
    assert block.needs is None or block.needs in NEEDS
    for command in block.commands:
        parse(command)


def test_the_command_line_knows_the_commands_of_the_readme() -> None:
    commands = commands_in_tables()
    assert len(commands) > 10
    for command in commands:
        parse(command)


def test_a_command_that_is_not_known_fails() -> None:
    with pytest.raises(SystemExit):
        parse(("demo", "--no-such-option"))


@pytest.mark.slow
@pytest.mark.parametrize("block", RUN, ids=lambda block: block.page)
def test_the_commands_run(block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module, options in (("rerun", ("--record",)), ("imageio_ffmpeg", (".mp4",))):
        wanted = any(word.endswith(options) for words in block.commands for word in words)
        if wanted and importlib.util.find_spec(module) is None:
            pytest.skip(f"needs the extra viz ({module})")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    if block.commands[0][0] in {"render", "report"}:  # of the search that the page ran before
        assert main(["demo", "--seed", "6", "--quiet"]) == 0
    for command in block.commands:
        words = [name for word in command for name in expanded(word)]
        assert main(words) == 0, words


def expanded(word: str) -> list[str]:
    """What a shell makes of a word."""
    return sorted(map(str, Path().glob(word))) if "*" in word else [word]


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)
def test_settings_that_pages_name_are_known(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for key, value in re.findall(r"\b((?:navigator|reasoning|env)\.[\w.]+)=([^\s`]+)", text):
        with_overrides(run_config("default"), {key: value})


def test_examples_that_pages_show_are_there() -> None:
    marks = [
        (page.name, line)
        for page in pages()
        for line in page.read_text(encoding="utf-8").splitlines()
        if re.match(r"-+ ?8 ?<", line)
    ]
    assert len(marks) >= 3
    for name, line in marks:
        included = re.fullmatch(r'--8<-- "(examples/\w+\.py)"', line)
        assert included is not None, f"{name}: not what includes a file: {line}"
        assert (ROOT / included[1]).is_file(), line


def test_the_links_of_the_readme_lead_somewhere() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)", text) if "://" not in link]
    assert len(links) > 20
    assert [link for link in links if not (ROOT / link).exists()] == []
