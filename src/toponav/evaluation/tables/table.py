"""What a table is, whatever it is rendered as."""

from __future__ import annotations

from dataclasses import dataclass, replace

from toponav.evaluation.statistics import Estimate

Cell = str | int | float | Estimate | None
"""A text, a count, a probability, a figure with its interval, or nothing."""

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
NOTHING = "-"


@dataclass(frozen=True)
class Column:
    """How the cells of a column are shown.

    Attributes:
        title: Its head, with the unit.
        label: Tells what a row is about: set to the left, and repeated on every panel.
        digits: Decimals of numbers.
        percent: Numbers are rates, shown in percent; the title says so.
        signed: Numbers are differences, shown with their sign.
        panel: Wide tables are split where they are read by people: the panel it belongs to.
    """

    title: str
    label: bool = False
    digits: int = 0
    percent: bool = False
    signed: bool = False
    panel: int = 0

    @property
    def scale(self) -> float:
        """What numbers are multiplied by."""
        return 100.0 if self.percent else 1.0

    def text(self, cell: Cell) -> str:
        """A cell for people: an interval in brackets, "-" for nothing."""
        if cell is None:
            return NOTHING
        if isinstance(cell, str):
            return printable(cell)
        if isinstance(cell, Estimate):
            return self._estimate(cell)
        if isinstance(cell, int):
            return str(cell)
        least = 10.0**-self.digits / self.scale
        return self._number(cell) if cell == 0.0 or cell >= least else f"<{self._number(least)}"

    def _estimate(self, estimate: Estimate) -> str:
        if estimate.value is None:
            return NOTHING
        value = self._number(estimate.value)
        if estimate.interval is None:
            return value
        low, high = map(self._number, estimate.interval)
        return f"{value} [{low},{NO_BREAK_SPACE}{high}]"

    def _number(self, number: float) -> str:
        scaled = round(number * self.scale, self.digits) + 0.0  # no negative zero
        return f"{scaled:{'+' if self.signed else ''}.{self.digits}f}"


@dataclass(frozen=True)
class Table:
    """A table and what must be said about it.

    Attributes:
        title: One line.
        columns: C columns.
        rows: Rows of C cells.
        notes: Lines under the table.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()

    def texts(self) -> list[list[str]]:
        """The cells for people, row by row."""
        return [
            [column.text(cell) for column, cell in zip(self.columns, row, strict=True)]
            for row in self.rows
        ]

    def panels(self) -> list[Table]:
        """The table cut into parts that fit a page: each has the labels, the last the notes."""
        numbers = sorted({column.panel for column in self.columns if not column.label})
        panels = [self._panel(number) for number in numbers] or [self]
        return [*panels[:-1], replace(panels[-1], notes=self.notes)]

    def _panel(self, number: int) -> Table:
        kept = [
            k for k, column in enumerate(self.columns) if column.label or column.panel == number
        ]
        return Table(
            self.title,
            tuple(self.columns[k] for k in kept),
            tuple(tuple(row[k] for k in kept) for row in self.rows),
        )


def split_interval(text: str) -> tuple[str, str]:
    """A cell's text as figure and interval in brackets; "" where it has no interval."""
    figure, _, interval = text.partition(" [")
    return (figure, f"[{interval}") if NO_BREAK_SPACE in interval else (text, "")


def printable(text: str) -> str:
    """Text from outside with everything that is no visible character or space as a space."""
    return "".join(character if character.isprintable() else " " for character in text)
