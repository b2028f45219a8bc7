"""Pictures show what they are given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from toponav.mapping.view import FREE, OCCUPIED, MapView, OccupancyGrid, PointCloud
from toponav.memory.graph import TopologicalMemory
from toponav.reasoning.base import PanoramaView, SeenObject
from toponav.reasoning.schema import Guidance
from toponav.reasoning.vlm.panorama_sheet import SheetLayout
from toponav.viz.film import save_film
from toponav.viz.panorama import CHOSEN, VERDICT_HEIGHT, VIEW_WIDTH, draw_panorama, save_panorama
from toponav.viz.topdown import TopDownPicture, draw_topdown, save_topdown


def cloud(points: list[list[float]]) -> PointCloud:
    xyz = np.asarray(points, np.float32).reshape(-1, 3)
    return PointCloud(xyz, np.full(xyz.shape, 90, np.uint8), np.ones(len(xyz), np.int32))


@pytest.fixture
def map_view() -> MapView:
    cells = np.zeros((40, 30), np.int8)
    cells[5:35, 5:25] = FREE
    cells[5, 5:25] = OCCUPIED
    return MapView(
        scene=cloud([]),
        objects={"bed": cloud([[1.0, 1.0, 0.5]]), "lamp": cloud([[2.0, 2.0, 1.0]])},
        navigable=cloud([]),
        obstacles=cloud([]),
        frontiers=np.array([[3.4, 1.0, 0.0], [3.4, 1.1, 0.0]]),
        frontier_labels=np.zeros(2, np.int64),
        grid=OccupancyGrid(cells, (0.0, 0.0), 0.1),
        floor_z=0.0,
    )


@pytest.fixture
def memory() -> TopologicalMemory:
    memory = TopologicalMemory()
    for position in ((1.0, 1.0), (2.5, 1.5)):
        node = memory.add_node(position, 0)
        memory.record_arrival(node.id)
    memory.describe_node(1, room_type="living room", frontier_count=3)
    memory.connect(1, 2, 1.7, 1.6)
    return memory


def texts(picture: TopDownPicture) -> set[str]:
    figure = draw_topdown(picture)
    axes = figure.axes[0]
    headings = {figure.get_suptitle(), axes.get_title()}
    return {text.get_text() for text in axes.texts} | headings


def test_the_top_down_picture_names_nodes_rooms_and_frontiers(
    map_view: MapView, memory: TopologicalMemory
) -> None:
    path = np.array([[1.0, 1.0, 0.0], [2.5, 1.5, 0.0]])
    shown = texts(TopDownPicture(map_view, path, memory, target="bed", title="a title"))
    assert {"1", "2", "living room f=3", "a title"} <= shown


def test_nodes_of_another_floor_are_left_out(map_view: MapView, memory: TopologicalMemory) -> None:
    upstairs = memory.add_node((1.5, 1.5), 1)
    assert str(upstairs.id) not in texts(TopDownPicture(map_view, np.zeros((0, 3)), memory))


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_picture_of_an_empty_search_is_written_whole(
    map_view: MapView, tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"map{suffix}"
    save_topdown(TopDownPicture(map_view, np.zeros((0, 3))), path)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]
    assert path.stat().st_size > 1000


def view(color: int) -> PanoramaView:
    image = np.full((30, 40, 3), color, np.uint8)
    return PanoramaView(image, 0.5, (SeenObject("tv_monitor", 0.9, 2.0),), 1.5, 7)


def test_the_panorama_marks_the_chosen_view() -> None:
    guidance = Guidance(node_id=1, direction=1, target_found=False, room_type="office")
    sheet = draw_panorama([view(10), view(20), view(30)], guidance, "bed")
    layout = SheetLayout(count=3, width=VIEW_WIDTH, height=180, lines=2)
    tops = [sheet.getpixel((left + VIEW_WIDTH // 2, 1)) for left, _ in map(layout.corner, range(3))]
    assert [top == CHOSEN for top in tops] == [False, True, False]
    assert sheet.size == (layout.size[0], layout.size[1] + VERDICT_HEIGHT)


def test_a_label_is_drawn_not_interpreted(tmp_path: Path) -> None:
    hostile = SeenObject("<script>\n{x} %s", 1.0, 1.0)
    views = [PanoramaView(np.zeros((3, 4, 3), np.uint8), 0.0, (hostile,), 0.0, 0)]
    save_panorama(views, None, "bed", tmp_path / "p.jpg")
    assert Image.open(tmp_path / "p.jpg").size[0] == VIEW_WIDTH


def test_a_film_of_few_colours_keeps_those_of_thin_lines(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    page = Image.fromarray(rng.integers(120, 230, (240, 320, 3), dtype=np.uint8))
    draw = ImageDraw.Draw(page)
    lines = {60: (24, 100, 171), 120: (43, 138, 62), 180: (163, 60, 192)}
    for y, color in lines.items():
        draw.line([(140, y), (180, y)], fill=color, width=2)
    assert save_film(iter([page, page]), tmp_path / "film.gif", rate=2.0) == 2
    with Image.open(tmp_path / "film.gif") as film:
        shown = np.asarray(film.convert("RGB"))
    for y, color in lines.items():
        assert np.abs(shown[y, 160].astype(int) - color).max() < 40
