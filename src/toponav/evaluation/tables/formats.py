"""A table as text: for a terminal, Markdown, LaTeX and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from toponav.evaluation.statistics import Estimate
from toponav.evaluation.tables.latex import latex
from toponav.evaluation.tables.table import Cell, Column, Table, printable
from toponav.evaluation.tables.terminal import terminal

Format = Literal["terminal", "markdown", "csv", "latex"]

SUFFIXES: dict[str, Format] = {".md": "markdown", ".csv": "csv", ".tex": "latex"}


def format_of(path: Path | None) -> Format:
    """The format that a file's name asks for; that of a terminal where it asks for none."""
    return "terminal" if path is None else SUFFIXES.get(path.suffix.lower(), "terminal")


def render(tables: Sequence[Table], form: Format, width: int | None = None) -> str:
    """Tables as one text, one after another, without a newline at its end.

    Args:
        tables: What to render.
        form: As what.
        width: Columns of the terminal; None for plain text as wide as it gets. The other formats
            have no width.
    """
    if form == "terminal":
        return "\n\n".join(terminal(table, width) for table in tables)
    return "\n\n".join(_RENDERERS[form](table) for table in tables)


def markdown(table: Table) -> str:
    """A GitHub table a panel under a bold title; the notes are a list."""
    lines = [f"**{_markdown_cell(table.title)}**", ""]
    for panel in table.panels():
        heads = [_markdown_cell(column.title) for column in panel.columns]
        rule = ["---" if column.label else "---:" for column in panel.columns]
        rows = [[_markdown_cell(text) for text in row] for row in panel.texts()]
        lines += [f"| {' | '.join(row)} |" for row in (heads, rule, *rows)]
        lines.append("")
    lines += [f"- {_markdown_cell(note)}" for note in table.notes]
    return "\n".join(lines).rstrip("\n")


def csv_text(table: Table) -> str:
    """Comma-separated values: all columns, unrounded, without title and notes.

    A column of figures with intervals becomes three: the figure, "low" and "high". Nothing known
    is an empty cell.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    split = [any(isinstance(row[k], Estimate) for row in table.rows)
             for k in range(len(table.columns))]  # fmt: skip
    heads: list[str] = []
    for column, has_interval in zip(table.columns, split, strict=True):
        title = printable(column.title)
        heads += [title, f"{title} low", f"{title} high"] if has_interval else [title]
    writer.writerow(heads)
    for row in table.rows:
        values: list[str | float | None] = []
        for column, cell, has_interval in zip(table.columns, row, split, strict=True):
            values += _csv_cells(column, cell) if has_interval else _csv_cells(column, cell)[:1]
        writer.writerow(values)
    return stream.getvalue().rstrip("\n")


def _csv_cells(column: Column, cell: Cell) -> list[str | float | None]:
    if isinstance(cell, Estimate):
        low, high = cell.interval or (None, None)
        numbers = (cell.value, low, high)
        return [None if number is None else number * column.scale for number in numbers]
    if isinstance(cell, str):
        return [printable(cell), None, None]
    return [cell, None, None]


def _markdown_cell(text: str) -> str:
    for special in "\\|`*<":
        text = text.replace(special, f"\\{special}")
    return printable(text)


_RENDERERS: dict[str, Callable[[Table], str]] = {
    "markdown": markdown,
    "latex": latex,
    "csv": csv_text,
}
