"""Write the table of names: docs/vocabulary.md.

Run as ``python docs/make_vocabulary_page.py``; a test holds the page against the table.
"""

from __future__ import annotations

from pathlib import Path

from toponav.categories import HM3D_TARGETS, MP3D_TARGETS, VOCABULARY, canonical
from toponav.perception.lookalikes import LOOKALIKES
from toponav.perception.onnx.model_card import coco_names

COCO_OF = {canonical(name): name for name in coco_names()}
PAGE = Path(__file__).parent / "vocabulary.md"

HEAD = """# The vocabulary

Every name that enters (a goal, a scene's category, a detector's class) is brought to one spelling
by `toponav.categories.canonical`: lower case, underscores, and of several spellings the first
column's. So `couch` finds what HM3D calls a sofa, and a detector trained on COCO's `potted plant`
finds plants. The spellings are those of COCO, Pascal VOC, LVIS, ADE20K, Objects365, HM3D and
Matterport3D, and of everyday language. Free text that is in no row stays what it is and is asked
for as it is: an open-vocabulary detector may know it.

*Asked as* is what an open-vocabulary detector is told. *Target of* names the ObjectNav benchmarks
that search for it. *COCO* is the class by which the three small models know it; without one they
never find it. *Taken for* gives what it is confused with and how often by the [noise
model](noise.md), in per cent.

| name | asked as | other spellings | target of | COCO | taken for |
| --- | --- | --- | --- | --- | --- |
"""


def page() -> str:
    """The whole page."""
    return HEAD + "".join(map(_row, VOCABULARY))


def _row(name: str) -> str:
    names = VOCABULARY[name]
    targets = [
        benchmark
        for benchmark, known in (("HM3D", HM3D_TARGETS), ("MP3D", MP3D_TARGETS))
        if name in known
    ]
    confused = [f"{other} {100 * rate:.2g}" for other, rate in LOOKALIKES.get(name, {}).items()]
    cells = (
        f"`{name}`",
        names.spoken,
        ", ".join(names.spellings),
        ", ".join(targets),
        COCO_OF.get(name, ""),
        ", ".join(confused),
    )
    return "| " + " | ".join(cells) + " |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
