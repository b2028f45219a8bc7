"""Tables as text: nothing is lost, nothing in a cell breaks out of it, LaTeX compiles."""

from __future__ import annotations

import csv
import io
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toponav.evaluation.statistics import Estimate
from toponav.evaluation.tables.formats import csv_text, format_of, markdown, render
from toponav.evaluation.tables.latex import escaped, latex
from toponav.evaluation.tables.table import Column, Table
from toponav.evaluation.tables.terminal import terminal

NASTY = r"a|b_c & 100% $x$ #1 {y} ~z^ \end{tabular} <i> [b] *c* `d` \"e\" żółć 椅子 " + "\x1b[31m\n"
TABLE = Table(
    "Runs",
    (
        Column("run", label=True),
        Column("SR [%]", digits=1, percent=True),
        Column("DTG [m]", digits=2),
        Column("difference", digits=1, signed=True),
        Column("p", digits=3),
        Column("steps", panel=1),
    ),
    (
        ("plain", Estimate(0.5, (0.25, 0.75), 8), Estimate(1.234, None, 8),
         Estimate(-2.0, (-4.0, 0.04), 8), 0.0001, 12),
        (NASTY, Estimate(None, (0.0, 1.0), 0), None, Estimate(0.02, (-0.01, 0.05), 8), 1.0, 7),
        ("[bracket first", Estimate(1.0, (0.6, 1.0), 8), Estimate(0.0, (0.0, 0.0), 8), None, 0.0,
         0),
    ),
    ("a note with 50 % & more",),
)  # fmt: skip
"""Every kind of cell, and names that mean something to each of the formats."""

names = st.text(st.characters(codec="utf-8"), max_size=12)


def named(name: str) -> Table:
    return Table(name, (Column(name, label=True), Column("n")), ((name, 1), ("next", 2)), (name,))


def test_numbers_as_people_read_them() -> None:
    plain, nasty, bracket = TABLE.texts()
    assert [text.replace("\N{NO-BREAK SPACE}", " ") for text in plain] == [
        "plain", "50.0 [25.0, 75.0]", "1.23", "-2.0 [-4.0, +0.0]", "<0.001", "12",
    ]  # fmt: skip
    assert nasty[1:3] == ["-", "-"]
    assert nasty[3] == "+0.0 [+0.0,\N{NO-BREAK SPACE}+0.1]"
    assert nasty[4:] == ["1.000", "7"]
    assert bracket[4:] == ["0.000", "0"]


def test_panels_repeat_the_labels_and_only_the_last_has_the_notes() -> None:
    first, second = TABLE.panels()
    assert [column.title for column in second.columns] == ["run", "steps"]
    assert second.rows[0] == ("plain", 12)
    assert (first.notes, second.notes) == ((), TABLE.notes)


def test_plain_text_has_no_colours_and_aligned_columns() -> None:
    text = terminal(TABLE, None)
    assert "\x1b" not in text
    lines = text.splitlines()
    assert lines[0] == "Runs"
    assert "50.0 [25.0, 75.0]" in text
    ends = {line.index("[%]") + 3 for line in lines if "[%]" in line}
    assert ends == {lines[2].index("75.0]") + 5}
    assert lines[-1] == TABLE.notes[0]


@pytest.mark.parametrize("width", [30, 40, 60, 80, 200])
def test_a_terminal_is_never_overrun_and_no_figure_is_cut(width: int) -> None:
    text = re.sub(r"\x1b\[\d*(;\d+)*m", "", terminal(TABLE, width))
    wide = "\N{CJK UNIFIED IDEOGRAPH-6905}"
    assert all(len(line) + line.count(wide) * 1 <= width for line in text.splitlines())
    for figure in ("50.0", "[25.0, 75.0]", "[-4.0, +0.0]", "<0.001", "1.23"):
        assert figure in text


@given(names)
@settings(max_examples=100)
def test_a_markdown_row_has_as_many_cells_as_the_head(name: str) -> None:
    rows = [line for line in markdown(named(name)).splitlines() if line.startswith("| ")]
    cells = {len(re.findall(r"(?<!\\)(?:\\\\)*\|", row)) for row in rows}
    assert cells == {3}
    assert len(rows) == 4


def test_markdown_by_hand() -> None:
    table = Table("T", (Column("a|b", label=True), Column("n")), (("x|y", 2),), ("so",))
    assert markdown(table) == "**T**\n\n| a\\|b | n |\n| --- | ---: |\n| x\\|y | 2 |\n\n- so"


@given(names)
@settings(max_examples=100)
def test_csv_reads_back(name: str) -> None:
    rows = list(csv.reader(io.StringIO(csv_text(named(name)), newline="")))
    shown = "".join(c if c.isprintable() else " " for c in name)
    assert rows == [[shown, "n"], [shown, "1"], ["next", "2"]]


def test_csv_has_every_column_and_interval_unrounded() -> None:
    head, first, second, _ = csv.reader(io.StringIO(csv_text(TABLE)))
    assert head[:6] == ["run", "SR [%]", "SR [%] low", "SR [%] high", "DTG [m]", "DTG [m] low"]
    assert first == ["plain", "50.0", "25.0", "75.0", "1.234", "", "", "-2.0", "-4.0", "0.04",
                     "0.0001", "12"]  # fmt: skip
    assert second[1:5] == ["", "0.0", "100.0", ""]
    assert len(head) == len(first) == len(second)


@given(names)
@settings(max_examples=200)
def test_latex_text_is_ascii_or_accented_and_balanced(name: str) -> None:
    text = escaped(name)
    plain = re.sub(r"\\[{}&%$#_`]", "", text).replace("\\text", "")
    assert not set(plain) & set('&%$#_^\\"|<>')
    assert plain.count("{") == plain.count("}")
    assert all(c.isascii() or c.isalpha() for c in text)
    assert "\n" not in text


def test_latex_by_hand() -> None:
    table = Table("50 %", (Column("run", label=True), Column("d", digits=1, signed=True)),
                  (("a_b", Estimate(-1.0, (-2.0, 0.5), 3)), ("[c", None)), ("so",))  # fmt: skip
    assert latex(table).splitlines()[2:] == [
        r"\caption{50 \%}",
        r"\begin{tabular}{lr}",
        r"\toprule",
        r"run & d \\",
        r"\midrule",
        r"a\_b & \shortstack[r]{$-$1.0\\{\scriptsize {[}$-$2.0,~+0.5{]}}} \\",
        r"{[}c & - \\",
        r"\bottomrule",
        r"\end{tabular}",
        r"\par\medskip",
        r"{\footnotesize so\par}",
        r"\end{table*}",
    ]


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex here")
def test_latex_compiles(tmp_path: Path) -> None:
    everything = "".join(map(chr, range(32, 0x250)))
    body = latex(TABLE) + "\n" + latex(named(everything)) + "\n" + latex(named("*[x]"))
    head = r"\documentclass{article}\usepackage{booktabs}\begin{document}"
    source = rf"{head}{body}\end{{document}}"
    (tmp_path / "t.tex").write_text(source, encoding="utf-8")
    result = subprocess.run(
        ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "t.tex"],
        cwd=tmp_path, capture_output=True, text=True, errors="replace", check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout[-1500:]


def test_several_tables_stand_apart() -> None:
    assert render([named("a"), named("b")], "csv") == "a,n\na,1\nnext,2\n\nb,n\nb,1\nnext,2"


@pytest.mark.parametrize(
    ("name", "form"),
    [("t.md", "markdown"), ("t.CSV", "csv"), ("t.tex", "latex"), ("t.txt", "terminal")],
)
def test_a_files_suffix_says_its_format(name: str, form: str) -> None:
    assert format_of(Path(name)) == form
    assert format_of(None) == "terminal"
