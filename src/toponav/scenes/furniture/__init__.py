"""Parametric furniture: a recognisable shape for every category, of any size.

Frame of a piece: the centre of its base is the origin, z points up, its width lies along x and its
depth along y. The front faces -y; the back (headboard, sofa back, the side that belongs against a
wall) is at +y. Whoever places furniture turns +y towards the wall.
"""

from toponav.scenes.furniture.catalog import BUILDERS, build_furniture
from toponav.scenes.furniture.shape import FurnitureMesh, Size

__all__ = ["BUILDERS", "FurnitureMesh", "Size", "build_furniture"]
