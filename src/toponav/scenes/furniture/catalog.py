"""Which shape each category has."""

from __future__ import annotations

from collections.abc import Callable

from toponav.categories import canonical
from toponav.scenes.furniture import (
    bathroom,
    beds,
    decor,
    electronics,
    kitchen,
    leisure,
    seating,
    storage,
    tables,
)
from toponav.scenes.furniture.primitives import Part, box
from toponav.scenes.furniture.shape import FurnitureMesh, Size, fit
from toponav.scenes.furniture.style import Style
from toponav.scenes.textures import paint

Builder = Callable[[Size, Style], list[Part]]
"""Makes the parts of a piece of roughly that size; `fit` makes the size exact."""


def plain_box(size: Size, style: Style) -> list[Part]:
    """What stands for a category without a shape of its own."""
    x, y, z = size[0] / 2.0, size[1] / 2.0, size[2]
    color = style.pick(((176, 168, 156), (150, 160, 170), (168, 156, 132)))
    return [box((-x, -y, 0.0), (x, y, z), paint(color))]


def steps(size: Size, style: Style) -> list[Part]:
    """A block of steps that rise towards the back."""
    sx, sy, sz = size
    count = max(1, round(sz / 0.17))
    surface = style.wood()
    return [
        box((-sx / 2.0, -sy / 2.0 + k * sy / count, 0.0),
            (sx / 2.0, -sy / 2.0 + (k + 1) * sy / count, (k + 1) * sz / count), surface)
        for k in range(count)
    ]  # fmt: skip


BUILDERS: dict[str, Builder] = {
    "bathtub": bathroom.bathtub,
    "bed": beds.bed,
    "bench": seating.bench,
    "bicycle": leisure.bicycle,
    "book": decor.book,
    "bookshelf": storage.bookshelf,
    "box": storage.moving_box,
    "cabinet": storage.cabinet,
    "car": leisure.car,
    "chair": seating.chair,
    "chest_of_drawers": storage.chest_of_drawers,
    "clothes": decor.clothes,
    "coffee_table": tables.coffee_table,
    "counter": kitchen.counter,
    "cushion": seating.cushion,
    "desk": tables.desk,
    "dishwasher": kitchen.dishwasher,
    "dryer": kitchen.dryer,
    "fireplace": decor.fireplace,
    "fridge": kitchen.fridge,
    "gym_equipment": leisure.gym_equipment,
    "lamp": decor.lamp,
    "laptop": electronics.laptop,
    "microwave": kitchen.microwave,
    "mirror": bathroom.mirror,
    "nightstand": storage.nightstand,
    "oven": kitchen.oven,
    "piano": leisure.piano,
    "picture": decor.wall_picture,
    "plant": decor.plant,
    "refuse_bin": decor.refuse_bin,
    "rug": decor.rug,
    "seating": seating.seating,
    "shoe_rack": storage.shoe_rack,
    "shower": bathroom.shower,
    "sink": bathroom.sink,
    "sofa": seating.sofa,
    "stairs": steps,
    "stool": seating.stool,
    "table": tables.table,
    "toilet": bathroom.toilet,
    "towel": bathroom.towel,
    "tv_monitor": electronics.tv_monitor,
    "tv_stand": storage.tv_stand,
    "wardrobe": storage.wardrobe,
    "washing_machine": kitchen.washing_machine,
    "workbench": tables.workbench,
}
"""The builder of every category that has a shape; any other one gets `plain_box`."""


def build_furniture(category: str, size: Size, variant: int = 0) -> FurnitureMesh:
    """The shape of a category, filling the box of `size` exactly.

    Args:
        category: Free text; spellings are resolved by `toponav.categories.canonical`.
        size: Extents along x, y and z, metres, each positive.
        variant: Chooses style and colours; equal arguments give equal shapes.
    """
    builder = BUILDERS.get(canonical(category), plain_box)
    return fit(builder(size, Style(variant)), size)
