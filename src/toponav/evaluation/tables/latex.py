r"""A table as LaTeX: needs `\usepackage{booktabs}` and nothing else."""

from __future__ import annotations

import unicodedata

from toponav.evaluation.tables.table import NO_BREAK_SPACE, Table, split_interval

SPECIAL = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "`": r"\`{}",
    '"': "''",
    "[": "{[}",  # after a line break or a rule it would begin an option
    "]": "{]}",
    "*": "{*}",
    NO_BREAK_SPACE: "~",
}
"""What LaTeX takes for more than a character."""

ACCENTS = frozenset(
    "0300 0301 0302 0303 0304 0306 0307 0308 030A 030B 030C".split()  # noqa: SIM905
)
"""Combining accents, in hexadecimal, that LaTeX can put on a letter in any encoding."""

BEYOND = "\u0180"
"""First character after the accented letters that pdfLaTeX knows without a package."""

LETTERS = frozenset("ßæœøłÆŒØŁıçÇ")
"""Other letters that it can print in any encoding."""


def escaped(text: str) -> str:
    """Text that LaTeX prints as it is; characters that pdfLaTeX cannot print become "?"."""
    return "".join(map(_escaped, text))


def latex(table: Table) -> str:
    """A table environment: the title is the caption, every panel a tabular, the notes below.

    It is as wide as the page, in a paper of two columns too.
    """
    caption = rf"\caption{{{escaped(table.title)}}}"
    lines = [r"\begin{table*}", r"\centering\footnotesize\setlength{\tabcolsep}{3pt}", caption]
    for panel in table.panels():
        kinds = "".join("l" if column.label else "r" for column in panel.columns)
        lines += [rf"\begin{{tabular}}{{{kinds}}}", r"\toprule"]
        lines += [_row([escaped(column.title) for column in panel.columns]), r"\midrule"]
        lines += [_row([_stacked(text) for text in row]) for row in panel.texts()]
        lines += [r"\bottomrule", r"\end{tabular}", r"\par\medskip"]
    lines += [rf"{{\footnotesize {escaped(note)}\par}}" for note in table.notes]
    return "\n".join([*lines, r"\end{table*}"])


def _row(cells: list[str]) -> str:
    return " & ".join(cells) + r" \\"


def _stacked(text: str) -> str:
    """A cell; a figure has its interval, if it has one, in small print under it."""
    figure, interval = split_interval(text)
    if not interval:
        return escaped(text)
    above, below = (escaped(part).replace("-", "$-$") for part in (figure, interval))
    return rf"\shortstack[r]{{{above}\\{{\scriptsize {below}}}}}"


def _escaped(character: str) -> str:
    if character in SPECIAL:
        return SPECIAL[character]
    if character.isascii():
        return character if character.isprintable() else " "
    _, _, accent = unicodedata.decomposition(character).partition(" ")
    known = character < BEYOND and accent in ACCENTS
    return character if known or character in LETTERS else "?"
