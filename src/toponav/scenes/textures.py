"""Procedural surfaces: small seeded images that tile, and the real size of one repeat.

Equal arguments give the same `Material` object, so a scene holds each image once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter

from toponav.scenes.mesh import Material

Rgb = tuple[int, int, int]
"""Red, green and blue, 0..255, sRGB."""

COARSE_PX = 64
"""Side of textures without fine structure."""

FINE_PX = 128
"""Side of textures whose lines must stay thin: boards, bricks, pictures."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A material and its real size.

    Attributes:
        material: The image.
        repeat_m: Metres that one repeat of it covers.
    """

    material: Material
    repeat_m: float


@cache
def paint(color: Rgb) -> Surface:
    """A plain colour."""
    return _surface("paint", np.full((1, 1, 3), color), 1.0)


@cache
def plaster(color: Rgb, seed: int = 0) -> Surface:
    """A painted wall, slightly uneven."""
    relief = 2.0 * _noise(seed, 0.6) + 2.5 * _noise(seed + 1, 6.0)
    return _surface("plaster", _tinted(color, relief), 1.6)


@cache
def wood(color: Rgb, seed: int = 0) -> Surface:
    """Veneer, its grain along u."""
    grain = 9.0 * _noise(seed, (0.7, 14.0)) + 5.0 * _noise(seed + 1, (3.0, 20.0))
    return _surface("wood", _tinted(color, grain), 0.8)


@cache
def planks(color: Rgb, seed: int = 0) -> Surface:
    """Floor boards 12.5 cm wide with staggered ends."""
    rng = np.random.default_rng(seed)
    boards, width = 8, FINE_PX // 8
    shade = 7.0 * _noise(seed, (0.7, 12.0), FINE_PX)
    for board in range(boards):
        rows = slice(board * width, (board + 1) * width)
        end = int(rng.integers(FINE_PX))
        tones = rng.normal(0.0, 11.0, size=2)
        columns = np.roll(np.repeat(tones, FINE_PX // 2), end)
        shade[rows] += columns
        shade[rows, [end, (end + FINE_PX // 2) % FINE_PX]] -= 38.0
        shade[board * width] -= 38.0
    return _surface("planks", _tinted(color, shade), 1.0)


@cache
def carpet(color: Rgb, seed: int = 0) -> Surface:
    """Short pile."""
    pile = 9.0 * _noise(seed, 0.5) + 5.0 * _noise(seed + 1, 3.0)
    return _surface("carpet", _tinted(color, pile), 0.7)


@cache
def fabric(color: Rgb, seed: int = 0) -> Surface:
    """Upholstery with a visible weave."""
    i, j = np.indices((COARSE_PX, COARSE_PX))
    weave = 5.0 * ((i // 2 + j // 2) % 2) + 4.0 * _noise(seed, 0.7) + 3.0 * _noise(seed + 1, 5.0)
    return _surface("fabric", _tinted(color, weave), 0.3)


@cache
def tiles(color: Rgb, tile_m: float = 0.3, seed: int = 0, second: Rgb | None = None) -> Surface:
    """Square tiles with grout; `second` makes a chequerboard."""
    size, half = FINE_PX, FINE_PX // 2
    rng = np.random.default_rng(seed)
    image = _tinted(color, 3.0 * _noise(seed, 4.0, size))
    for row in range(2):
        for column in range(2):
            block = np.s_[row * half : (row + 1) * half, column * half : (column + 1) * half]
            if second is not None and (row + column) % 2:
                image[block] += np.subtract(second, color)
            image[block] += rng.normal(0.0, 3.0)
    grout = np.mean(color) * 0.8
    for line in (0, half):
        image[line : line + 3] = grout
        image[:, line : line + 3] = grout
    return _surface("tiles", image, 2.0 * tile_m)


@cache
def brick(color: Rgb, seed: int = 0) -> Surface:
    """Bricks of 25 cm by 7.5 cm in running bond."""
    rng = np.random.default_rng(seed)
    rows, columns = 8, 2
    height, width = FINE_PX // rows, FINE_PX // columns
    image = _tinted(color, 8.0 * _noise(seed, 1.0, FINE_PX))
    mortar = (196.0, 188.0, 176.0)
    for row in range(rows):
        course = image[row * height : (row + 1) * height]
        for column in range(columns):
            start = column * width + (row % 2) * width // 2
            course[:, np.arange(start, start + width) % FINE_PX] += rng.normal(0.0, 13.0)
            course[:, [start % FINE_PX, (start + 1) % FINE_PX]] = mortar
        course[:2] = mortar
    return _surface("brick", image, 0.5)


@cache
def marble(color: Rgb, seed: int = 0) -> Surface:
    """Polished stone with veins."""
    warp = _noise(seed, 8.0, FINE_PX)
    veins = np.exp(-((warp / 0.09) ** 2))
    return _surface(
        "marble", _tinted(color, 4.0 * _noise(seed + 1, 3.0, FINE_PX) - 38 * veins), 0.9
    )


@cache
def concrete(color: Rgb, seed: int = 0) -> Surface:
    """Bare screed."""
    spots = 4.0 * _noise(seed, 0.6) + 6.0 * _noise(seed + 1, 5.0)
    return _surface("concrete", _tinted(color, spots), 1.5)


@cache
def brushed_metal(color: Rgb, seed: int = 0) -> Surface:
    """Steel with fine lines along u."""
    return _surface("metal", _tinted(color, 5.0 * _noise(seed, (0.5, 18.0))), 0.5)


@cache
def foliage(color: Rgb, seed: int = 0) -> Surface:
    """Leaves: mottled green."""
    return _surface("foliage", _tinted(color, 12.0 * _noise(seed, 2.0)), 0.15)


@cache
def book_spines(seed: int = 0) -> Surface:
    """Books side by side along u, one shelf high along v."""
    rng = np.random.default_rng(seed)
    image = np.zeros((COARSE_PX, COARSE_PX, 3))
    column = 0
    while column < COARSE_PX:
        width = int(rng.integers(3, 8))
        spine = rng.integers(40, 215, size=3).astype(np.float64)
        image[:, column : column + width] = spine
        image[:, column] = 0.4 * spine
        label = int(rng.integers(10, 40))
        image[label : label + 8, column + 1 : column + width - 1] = 0.4 * spine + 140.0
        column += width
    return _surface("book spines", image, 0.35)


@cache
def rug_pattern(color: Rgb, seed: int = 0) -> Surface:
    """A woven rug: borders and a lozenge; made for unit texture coordinates."""
    i, j = np.indices((FINE_PX, FINE_PX)) / (FINE_PX - 1.0) * 2.0 - 1.0
    to_edge = np.maximum(np.abs(i), np.abs(j))
    ring = np.abs(i) + np.abs(j)
    image = _tinted(color, 6.0 * _noise(seed, 0.6, FINE_PX))
    light = np.add(np.multiply(color, 0.35), 140.0)
    dark = np.multiply(color, 0.45)
    image[(to_edge > 0.78) & (to_edge < 0.86)] = light
    image[to_edge > 0.93] = dark
    image[(ring > 0.45) & (ring < 0.58)] = light
    image[ring < 0.22] = dark
    return _surface("rug", image, 1.0)


@cache
def television_image(seed: int = 0) -> Surface:
    """A bright landscape, as a switched-on screen shows; for unit texture coordinates."""
    rng = np.random.default_rng(seed)
    image = np.zeros((COARSE_PX, COARSE_PX, 3))
    v = np.linspace(0.0, 1.0, COARSE_PX)[:, None]
    image[:] = ((1.0 - v) * (70, 140, 235) + v * (190, 225, 255))[:, None, :]
    columns = np.arange(COARSE_PX)
    for level, color in ((0.55, (60, 120, 110)), (0.75, (70, 165, 80))):
        phase, waves = rng.random() * 6.3, rng.integers(1, 4)
        top = level + 0.07 * np.sin(2.0 * np.pi * waves * columns / COARSE_PX + phase)
        image[v > top[None, :]] = color
    i, j = np.indices((COARSE_PX, COARSE_PX))
    image[(i - 14) ** 2 + (j - 46) ** 2 < 36] = (255, 245, 190)
    return _surface("television image", image, 1.0)


@cache
def desktop_image(seed: int = 0) -> Surface:
    """Windows on a computer's screen; for unit texture coordinates."""
    rng = np.random.default_rng(seed)
    image = np.full((COARSE_PX, COARSE_PX, 3), (44.0, 104.0, 178.0))
    image[6:48, 6:40] = (236, 240, 244)
    image[6:10, 6:40] = (120, 132, 148)
    for row in range(14, 44, 4):
        image[row : row + 2, 9 : 9 + int(rng.integers(10, 29))] = (96, 104, 120)
    image[18:56, 44:60] = (250, 222, 150)
    image[-4:] = (28, 34, 48)
    return _surface("desktop image", image, 1.0)


@cache
def artwork(seed: int = 0) -> Surface:
    """A painting: landscape or abstract; for unit texture coordinates."""
    rng = np.random.default_rng(seed)
    if seed % 2:
        return _surface("artwork", _landscape(rng), 1.0)
    image = np.full((COARSE_PX, COARSE_PX, 3), rng.integers(190, 240, size=3).astype(np.float64))
    i, j = np.indices((COARSE_PX, COARSE_PX))
    for _ in range(7):
        color = rng.integers(30, 235, size=3)
        row, column = rng.integers(0, COARSE_PX, size=2)
        radius = int(rng.integers(6, 20))
        if rng.random() < 0.5:
            image[(i - row) ** 2 + (j - column) ** 2 < radius**2] = color
        else:
            image[np.abs(i - row + _STROKE_SLANT * (j - column)) < radius / 3.0] = color
    return _surface("artwork", image, 1.0)


_STROKE_SLANT = 0.35


def _landscape(rng: np.random.Generator) -> NDArray[np.float64]:
    """Hills before a sky."""
    v = np.linspace(0.0, 1.0, COARSE_PX)[:, None]
    sky, horizon = rng.integers(120, 230, size=3), rng.integers(190, 250, size=3)
    image = ((1.0 - v) * sky + v * horizon)[:, None, :].repeat(COARSE_PX, axis=1)
    columns = np.arange(COARSE_PX)
    for level in (0.45, 0.6, 0.78):
        phase, waves = rng.random() * 6.3, rng.integers(1, 3)
        top = level + 0.08 * np.sin(2.0 * np.pi * waves * columns / COARSE_PX + phase)
        image[v > top[None, :]] = rng.integers(30, 150, size=3)
    return image


def _noise(
    seed: int, smoothness: float | tuple[float, float], size: int = COARSE_PX
) -> NDArray[np.float64]:
    """(size, size) noise that tiles, mean 0 and standard deviation 1."""
    white = np.random.default_rng(seed).standard_normal((size, size))
    smooth = gaussian_filter(white, smoothness, mode="wrap")
    smooth -= smooth.mean()
    normalised: NDArray[np.float64] = smooth / smooth.std()
    return normalised


def _tinted(color: ArrayLike, shade: NDArray[np.float64]) -> NDArray[np.float64]:
    """(h, w, 3): a colour made lighter and darker in proportion to its brightness."""
    base = np.asarray(color, dtype=np.float64)
    return base + shade[..., None] * (0.35 + 0.65 * base / 255.0)


def _surface(name: str, image: NDArray[np.generic], repeat_m: float) -> Surface:
    texture = np.clip(np.round(np.asarray(image, np.float64)), 0, 255).astype(np.uint8)
    return Surface(Material(name, texture), repeat_m)
