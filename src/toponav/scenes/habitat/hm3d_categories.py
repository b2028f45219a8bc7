"""What HM3D's annotators wrote, as the benchmark's categories.

The table is the one of raw names that Habitat publishes with HM3D's semantics (habitat-sim, MIT
licence), reduced to the names that it gives another category than their own spelling would.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from toponav.categories import canonical

TABLE = "hm3d_categories.tsv"


@cache
def _table() -> dict[str, str]:
    lines = files(__package__).joinpath(TABLE).read_text(encoding="utf-8").splitlines()
    return dict(line.split("\t") for line in lines if line and not line.startswith("#"))


def hm3d_category(raw: str) -> str:
    """The canonical category of an annotator's name; one that is not in the table is its own."""
    name = raw.strip().lower()
    return _table().get(name, canonical(name))
