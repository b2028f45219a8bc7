"""What is taken for what: confusions between categories that detectors and models make."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

LOOKALIKES: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "armchair": {"sofa": 0.2},
        "bathtub": {"sink": 0.05, "bed": 0.02},
        "bed": {"sofa": 0.06},
        "bench": {"table": 0.06, "sofa": 0.06, "chair": 0.05},
        "bookshelf": {"cabinet": 0.08, "wardrobe": 0.04},
        "cabinet": {"chest_of_drawers": 0.1, "wardrobe": 0.06, "fridge": 0.03},
        "chair": {"sofa": 0.05, "stool": 0.04, "toilet": 0.005},
        "chest_of_drawers": {"cabinet": 0.1, "nightstand": 0.05},
        "coffee_table": {"table": 0.12, "stool": 0.03},
        "counter": {"table": 0.05, "cabinet": 0.06},
        "cushion": {"bed": 0.01},
        "desk": {"table": 0.15},
        "dishwasher": {"oven": 0.08, "washing_machine": 0.06},
        "dryer": {"washing_machine": 0.3},
        "fridge": {"wardrobe": 0.04, "cabinet": 0.04},
        "lamp": {"plant": 0.02},
        "laptop": {"tv_monitor": 0.05, "book": 0.05},
        "microwave": {"oven": 0.1, "tv_monitor": 0.04},
        "mirror": {"picture": 0.06, "tv_monitor": 0.04, "window": 0.04},
        "nightstand": {"chest_of_drawers": 0.1, "cabinet": 0.06},
        "oven": {"microwave": 0.06, "dishwasher": 0.04},
        "picture": {"tv_monitor": 0.05, "mirror": 0.04},
        "plant": {"lamp": 0.01},
        "seating": {"chair": 0.3, "sofa": 0.2},
        "sink": {"toilet": 0.03, "bathtub": 0.03},
        "sofa": {"chair": 0.06, "bed": 0.05},
        "stool": {"chair": 0.12, "toilet": 0.01},
        "table": {"desk": 0.06, "counter": 0.03},
        "toilet": {"sink": 0.02, "chair": 0.02},
        "towel": {"clothes": 0.08},
        "tv_monitor": {"picture": 0.05, "mirror": 0.02},
        "tv_stand": {"cabinet": 0.1, "chest_of_drawers": 0.08, "table": 0.05},
        "wardrobe": {"cabinet": 0.1, "fridge": 0.03},
        "washing_machine": {"dryer": 0.1, "oven": 0.03},
        "whiteboard": {"tv_monitor": 0.1, "picture": 0.1},
        "window": {"picture": 0.05, "tv_monitor": 0.03},
        "workbench": {"table": 0.15, "desk": 0.1},
    }
)
"""True category to what it is taken for and how often, from one side of one object.

The pairs are those that the confusion matrices of COCO, LVIS and ADE20K show for furniture, and
that navigation papers name as causes of wrong stops; the rates are round figures of that size.
`docs/noise.md` tells what was measured.
"""


def lookalikes(category: str) -> Mapping[str, float]:
    """What a category is taken for, and how often."""
    return LOOKALIKES.get(category, {})
