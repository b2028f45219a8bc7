"""A table for a terminal, or plain for a pipe."""

from __future__ import annotations

import io
from dataclasses import replace

from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from toponav.evaluation.tables.table import NO_BREAK_SPACE, Table, printable, split_interval

PLAIN_WIDTH = 10_000
"""No line of a pipe is wrapped."""

PADDING, BETWEEN = 1, 1
"""Spaces on either side of a column, and what stands between two columns."""

LABEL_SHARE = 3
"""A label takes at most this part of a terminal's width; longer ones are folded."""


def terminal(table: Table, width: int | None) -> str:
    """Every panel as a grid, the notes below.

    Where a terminal is narrow, intervals stand under their figures, and panels are cut further.

    Args:
        table: What to show.
        width: Columns of the terminal; None for plain aligned text, without wrapping or styles.
    """
    stream = io.StringIO()
    console = Console(
        file=stream, width=width or PLAIN_WIDTH, force_terminal=width is not None,
        color_system=None if width is None else "standard", highlight=False,
    )  # fmt: skip
    console.print(Text(printable(table.title), style="bold"))
    for panel in table.panels():
        for grid in _grids(panel, width):
            console.print(grid)
            console.print()
    for note in table.notes:
        console.print(Text(printable(note), style="dim"))
    lines = [line.rstrip() for line in stream.getvalue().splitlines()]
    return "\n".join(lines).rstrip("\n").replace(NO_BREAK_SPACE, " ")


def _grids(panel: Table, width: int | None) -> list[RichTable]:
    texts = panel.texts()
    if width is None or sum(_widths(panel, texts, PLAIN_WIDTH)) <= width:
        return [_grid(panel, texts, width)]
    stacked = [["\n".join(filter(None, split_interval(text))) for text in row] for row in texts]
    return [
        _grid(_columns_of(panel, kept), [[row[k] for k in kept] for row in stacked], width)
        for kept in _cuts(panel, _widths(panel, stacked, width // LABEL_SHARE), width)
    ]


def _widths(panel: Table, texts: list[list[str]], longest_label: int) -> list[int]:
    """Characters that each column takes, the gap to its neighbour included."""
    widths = []
    for k, column in enumerate(panel.columns):
        lines = [column.title, *(line for row in texts for line in row[k].split("\n"))]
        natural = max(map(len, lines))
        widths.append(
            (min(natural, longest_label) if column.label else natural) + 2 * PADDING + BETWEEN
        )
    return widths


def _cuts(panel: Table, widths: list[int], width: int) -> list[list[int]]:
    """Indices of the columns of each part: the labels, and as many others as fit."""
    labels = [k for k, column in enumerate(panel.columns) if column.label]
    room = width - sum(widths[k] for k in labels)
    parts: list[list[int]] = []
    left = 0
    for k, column in enumerate(panel.columns):
        if column.label:
            continue
        if not parts or widths[k] > left:
            parts.append([*labels])
            left = room
        parts[-1].append(k)
        left -= widths[k]
    return parts or [labels]


def _columns_of(panel: Table, kept: list[int]) -> Table:
    return replace(panel, columns=tuple(panel.columns[k] for k in kept), rows=())


def _grid(panel: Table, texts: list[list[str]], width: int | None) -> RichTable:
    style = None if width is None else box.SIMPLE_HEAD
    grid = RichTable(box=style, padding=(0, PADDING), show_edge=False)
    for column in panel.columns:
        label = column.label
        grid.add_column(
            Text(printable(column.title)), justify="left" if label else "right", no_wrap=not label,
            overflow="fold", max_width=width // LABEL_SHARE if label and width else None,
        )  # fmt: skip
    for row in texts:
        grid.add_row(*map(Text, row))
    return grid
