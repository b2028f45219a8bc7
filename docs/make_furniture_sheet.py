"""Draws docs/images/furniture.png and docs/images/rooms.png: what the embedded scenes look like.

Run `python docs/make_furniture_sheet.py`; the simulator's own renderer makes both pictures.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw
from shapely import Point, Polygon

from toponav.categories import CONTEXT_CATEGORIES, HM3D_TARGETS, MP3D_TARGETS, readable
from toponav.envs.simulator.renderer import Renderer
from toponav.geometry import Intrinsics, Pose
from toponav.scenes.building.soup import TriangleSoup
from toponav.scenes.furniture import build_furniture
from toponav.scenes.furniture.primitives import box
from toponav.scenes.furniture_sizes import SIZE_RANGES, UNKNOWN_SIZE
from toponav.scenes.generate import generate_house
from toponav.scenes.house import House, Level, Room
from toponav.scenes.mesh import SceneMesh
from toponav.scenes.meshing import build_scene
from toponav.scenes.textures import paint

IMAGES = Path(__file__).parent / "images"

COLUMNS = 8
CELL = (176, 160)
LABEL_PX = 16
SIZES = {"stairs": (1.0, 1.6, 1.2), "mirror": (0.6, 0.04, 0.9)}

ROOM_TYPES = ("living room", "bedroom", "kitchen", "bathroom", "office", "dining room")
ROOM_CELL = (400, 300)
EYE_M = 1.1


def look_at(eye: ArrayLike, target: ArrayLike) -> Pose:
    """A level-headed camera at `eye` that looks at `target`."""
    forward = np.subtract(target, eye)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    return Pose.from_rotation(np.stack([right, down, forward], axis=1), eye)


def draw_piece(category: str, variant: int) -> NDArray[np.uint8]:
    """One piece before a wall, seen from its front right."""
    ranges = SIZE_RANGES.get(category, UNKNOWN_SIZE)
    size = SIZES.get(category, tuple(float(np.mean(span)) for span in ranges))
    piece = build_furniture(category, size, variant)
    soup = TriangleSoup()
    index = [soup.material(material) for material in piece.materials]
    lift = 1.2 if category in ("picture", "mirror", "towel") else 0.0
    corners = piece.vertices[piece.faces] + (0.0, -size[1] / 2.0, lift)
    soup.add(0, corners, piece.face_uv, (index[k] for k in piece.face_material))
    for low, high, surface in (
        ((-20.0, -20.0, -0.1), (20.0, 0.1, 0.0), paint((176, 150, 118))),
        ((-20.0, 0.001, 0.0), (20.0, 0.1, 8.0), paint((226, 226, 220))),
    ):
        part = box(low, high, surface)
        material = soup.material(surface.material)
        soup.add(0, part.corners, part.uv, [material] * len(part.corners))
    middle = np.array([0.0, -size[1] / 2.0, lift + size[2] / 2.0])
    distance = 1.05 * float(np.linalg.norm(size)) + 0.12
    height = middle[2] + 0.15 if lift else min(max(0.88, size[2] * 0.75), 0.3 + distance)
    angle = math.radians(28.0)
    eye = middle + distance * np.array([math.sin(angle), -math.cos(angle), 0.0])
    camera = look_at((eye[0], eye[1], height), middle)
    return render(soup.mesh(), camera, (CELL[0], CELL[1] - LABEL_PX), 62.0)


def render(
    mesh: SceneMesh, camera: Pose, size: tuple[int, int], hfov_deg: float
) -> NDArray[np.uint8]:
    """An image at twice the resolution, averaged down."""
    width, height = size
    intrinsics = Intrinsics.from_hfov(2 * width, 2 * height, hfov_deg)
    image = Renderer(mesh).render(camera, intrinsics).rgb.astype(np.uint16)
    return (image.reshape(height, 2, width, 2, 3).sum(axis=(1, 3)) // 4).astype(np.uint8)


def sheet(
    cells: list[tuple[str, NDArray[np.uint8]]], columns: int, size: tuple[int, int]
) -> Image.Image:
    """Labelled images in a grid."""
    rows = math.ceil(len(cells) / columns)
    picture = Image.new("RGB", (columns * size[0], rows * size[1]), "white")
    pen = ImageDraw.Draw(picture)
    for number, (label, image) in enumerate(cells):
        x, y = number % columns * size[0], number // columns * size[1]
        picture.paste(Image.fromarray(image), (x, y))
        pen.text((x + 4, y + size[1] - LABEL_PX + 2), label, fill="black")
    return picture


def room_view(house: House, level: Level, room: Room) -> tuple[float, NDArray[np.uint8]]:
    """The view of a room from the corner that shows most objects, and how many it shows."""
    mesh = build_scene(house).mesh
    polygon = Polygon(room.polygon)
    middle = polygon.representative_point()
    blocked = [Point(o.position[:2]).buffer(max(o.size[:2]) / 2.0) for o in level.objects]
    best: tuple[float, NDArray[np.uint8]] = (-1.0, np.zeros((1, 1, 3), np.uint8))
    renderer = Renderer(mesh)
    structure = {i.id for i in mesh.instances if i.category in ("wall", "floor", "ceiling")}
    for corner in room.polygon:
        away = np.subtract((middle.x, middle.y), corner)
        spot = np.add(corner, 0.5 * away / np.linalg.norm(away))
        if any(shape.contains(Point(spot)) for shape in blocked):
            continue
        camera = look_at((*spot, level.floor + EYE_M), (middle.x, middle.y, level.floor + 0.75))
        preview = renderer.render(camera, Intrinsics.from_hfov(80, 60, 90.0))
        ids, counts = np.unique(preview.instance_ids, return_counts=True)
        score = sum(
            1.0 for k, n in zip(ids, counts, strict=True) if k not in structure and 15 < n < 1400
        )
        if score > best[0]:
            best = (score, render(mesh, camera, (ROOM_CELL[0], ROOM_CELL[1] - LABEL_PX), 90.0))
    return best


def best_rooms(seeds: range) -> list[tuple[str, NDArray[np.uint8]]]:
    """For each room type the fullest view among some generated houses."""
    best: dict[str, tuple[float, NDArray[np.uint8]]] = {}
    for seed in seeds:
        house = generate_house(seed)
        for level in house.levels:
            for room in level.rooms:
                if room.type in ROOM_TYPES:
                    view = room_view(house, level, room)
                    best[room.type] = max(best.get(room.type, view), view, key=lambda v: v[0])
    return [(kind, best[kind][1]) for kind in ROOM_TYPES if kind in best]


def main() -> None:
    """Write both pictures."""
    IMAGES.mkdir(exist_ok=True)
    categories = dict.fromkeys((*HM3D_TARGETS, *MP3D_TARGETS, *CONTEXT_CATEGORIES))
    cells = [
        (readable(category), draw_piece(category, variant))
        for variant, category in enumerate(categories)
    ]
    sheet(cells, COLUMNS, CELL).save(IMAGES / "furniture.png", optimize=True)
    rooms = sheet(best_rooms(range(6)), 3, ROOM_CELL)
    rooms.quantize(256).save(IMAGES / "rooms.png", optimize=True)


if __name__ == "__main__":
    main()
