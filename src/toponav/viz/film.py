"""A search as a film: what the camera sees, its depth, and the map as it grows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from toponav.categories import readable
from toponav.errors import InputError, MissingExtraError
from toponav.files import temporary_beside
from toponav.mapping.semantic_map import MapConfig, SemanticMap
from toponav.mapping.view import FREE, OCCUPIED, UNKNOWN, MapView
from toponav.memory.graph import TopologicalMemory
from toponav.memory.snapshot import UNKNOWN_ROOM, MemorySnapshot
from toponav.policy.decision import Decision
from toponav.types import Action, Detections, Observation
from toponav.viz.labels import on_this_floor

KINDS = (".mp4", ".gif")
PANEL = (360, 270)
"""Width and height of the RGB and of the depth image, pixels."""
MAP_SIDE = 2 * PANEL[1]
CAPTION = 50
LAST_S = 2.0
"""How long the last frame stays."""
MARGIN_M = 0.5
FAR_M = 5.0
PAPER, INK, FREE_COLOR, WALL = (255, 255, 255), (33, 37, 41), (228, 233, 238), (74, 85, 96)
FRONTIER, PATH, NODE, TARGET = (240, 140, 0), (25, 113, 194), (47, 158, 68), (224, 49, 49)
PURPLE = (174, 62, 201)
NEAR_COLOR, MIDDLE_COLOR, FAR_COLOR = (252, 233, 120), (205, 70, 110), (35, 20, 90)


@dataclass(frozen=True, eq=False)
class Moment:
    """What one frame shows."""

    step: int
    action: str
    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    position: NDArray[np.float64]
    yaw: float
    cells: NDArray[np.int8]
    origin: tuple[float, float]
    resolution: float
    frontiers: NDArray[np.float64]
    decision: int


@dataclass
class FilmCamera:
    """Watches an episode and keeps what its film needs: 0.4 MB a step.

    Between decisions the agent's own map is not told, so that the map on the film is built here, of
    the same images; objects, memory and waypoint are those of the agent's last decision.
    """

    map_config: MapConfig
    every: int = 1
    moments: list[Moment] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Start with an empty map."""
        self._map = SemanticMap(self.map_config)

    def on_step(self, observation: Observation, action: Action) -> None:
        """Keep one moment; the last action is always kept."""
        height, width = observation.depth.shape
        self._map.integrate(observation, Detections.empty(height, width))
        if observation.step % self.every and action is not Action.STOP:
            return
        view = self._map.view()
        small = np.asarray(Image.fromarray(observation.rgb).resize(PANEL))
        depth = np.asarray(
            Image.fromarray(observation.depth).resize(PANEL, Image.Resampling.NEAREST)
        )
        self.moments.append(
            Moment(
                observation.step, action.name.lower().replace("_", " "), small, depth,
                observation.world_from_base.translation.copy(), observation.world_from_base.yaw,
                view.grid.cells.copy(), view.grid.origin, view.grid.resolution,
                view.frontiers[:, :2].copy(), len(self.decisions) - 1,
            )
        )  # fmt: skip

    def on_decision(self, decision: Decision) -> None:
        """Keep a decision."""
        self.decisions.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Nothing further is needed."""
        del map_view, memory


@dataclass(frozen=True)
class Frame:
    """Places of the map on the page: (x, y) metres to pixels, the same in all frames."""

    low: NDArray[np.float64]
    pixels_per_m: float

    def at(self, xy: NDArray[np.floating]) -> list[tuple[float, float]]:
        """Pixels of (N, 2) places; y points up in the world and down on the page."""
        place = (np.asarray(xy).reshape(-1, 2) - self.low) * self.pixels_per_m
        return [(float(x), float(MAP_SIDE - y)) for x, y in place]


def draw_film(camera: FilmCamera, target: str, verdict: str) -> Iterator[Image.Image]:
    """The frames, all of one size; the last says the verdict."""
    frame = _frame_of(camera.moments)
    for k, moment in enumerate(camera.moments):
        page = Image.new("RGB", (PANEL[0] + MAP_SIDE, MAP_SIDE + CAPTION), PAPER)
        page.paste(Image.fromarray(moment.rgb), (0, 0))
        page.paste(Image.fromarray(depth_colors(moment.depth)), (0, PANEL[1]))
        page.paste(_draw_map(camera, k, frame, target), (PANEL[0], 0))
        last = k == len(camera.moments) - 1
        first_line = f"searching for: {readable(target)}   step {moment.step}   {moment.action}"
        _write(page, verdict if last else first_line, _thought(camera, moment))
        yield page


def depth_colors(depth: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(H, W, 3) colours of (H, W) metres: near is bright, without a return white."""
    share = np.clip(depth / FAR_M, 0.0, 1.0)[..., None]
    near, middle, far = (np.array(color) for color in (NEAR_COLOR, MIDDLE_COLOR, FAR_COLOR))
    front = near + (middle - near) * np.minimum(2.0 * share, 1.0)
    colors = front + (far - middle) * np.maximum(2.0 * share - 1.0, 0.0)
    colors[depth == 0.0] = PAPER
    return np.asarray(colors, np.uint8)


def save_film(frames: Iterator[Image.Image], path: Path, rate: float) -> int:
    """Write an MP4 (H.264) or GIF file, told by its ending; returns the number of frames.

    Raises:
        InputError: Neither of them.
        MissingExtraError: MP4 needs the extra `viz`.
    """
    writers = {".mp4": _write_mp4, ".gif": _write_gif}
    if path.suffix not in writers:
        raise InputError(f"{path}: a video is a {' or '.join(KINDS)} file; choose one of these")
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = temporary_beside(path)
    try:
        count = writers[path.suffix](frames, temporary, rate)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    return count


def import_ffmpeg() -> Any:
    """The module that brings FFmpeg.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise MissingExtraError(
            "MP4 needs FFmpeg: pip install 'toponav[viz]', or write a .gif"
        ) from error
    return imageio_ffmpeg


def _write_mp4(frames: Iterator[Image.Image], path: Path, rate: float) -> int:
    ffmpeg = import_ffmpeg()
    count, writer, image = 0, None, None
    for image in frames:
        if writer is None:
            writer = ffmpeg.write_frames(
                str(path), image.size, fps=rate, codec="libx264", quality=7, macro_block_size=2,
                ffmpeg_log_level="error",
            )  # fmt: skip
            writer.send(None)
        writer.send(image.tobytes())
        count += 1
    if writer is not None and image is not None:
        for _ in range(round(LAST_S * rate)):
            writer.send(image.tobytes())
        writer.close()
    return count


def _write_gif(frames: Iterator[Image.Image], path: Path, rate: float) -> int:
    # An octree keeps the colours of thin lines, which a median cut gives to large areas.
    octree, plain = Image.Quantize.FASTOCTREE, Image.Dither.NONE
    images = [image.quantize(128, octree, dither=plain) for image in frames]
    times = [round(1000.0 / rate)] * len(images)
    times[-1] += round(1000.0 * LAST_S)
    images[0].save(path, save_all=True, append_images=images[1:], duration=times, loop=0)
    return len(images)


def _frame_of(moments: Sequence[Moment]) -> Frame:
    """A square that holds everything that is known at any moment."""
    corners = []
    for moment in moments:
        known = np.argwhere(moment.cells != UNKNOWN)
        if len(known):
            ends = np.array([known.min(axis=0), known.max(axis=0) + 1])
            corners.append(ends * moment.resolution + moment.origin)
        corners.append(moment.position[None, :2])
    places = np.concatenate(corners)
    low, high = places.min(axis=0) - MARGIN_M, places.max(axis=0) + MARGIN_M
    side = float((high - low).max())
    return Frame((low + high - side) / 2.0, MAP_SIDE / side)


def _draw_map(camera: FilmCamera, k: int, frame: Frame, target: str) -> Image.Image:
    moment = camera.moments[k]
    page = Image.new("RGB", (MAP_SIDE, MAP_SIDE), PAPER)
    _draw_cells(page, moment, frame)
    draw = ImageDraw.Draw(page)
    decision = camera.decisions[moment.decision] if moment.decision >= 0 else None
    half = 0.5 * moment.resolution * frame.pixels_per_m
    for x, y in frame.at(moment.frontiers):
        draw.rectangle((x - half, y - half, x + half, y + half), fill=FRONTIER)
    if decision is not None:
        _draw_objects(draw, decision.map_view, frame, target)
    path = frame.at(np.array([m.position[:2] for m in camera.moments[: k + 1]]))
    if len(path) > 1:
        draw.line(path, fill=PATH, width=3, joint="curve")
    if decision is not None:
        _draw_thought(draw, decision, frame)
    _draw_agent(draw, moment, frame)
    return page


def _draw_cells(page: Image.Image, moment: Moment, frame: Frame) -> None:
    colors = np.full((*moment.cells.shape, 3), 255, np.uint8)
    colors[moment.cells == FREE] = FREE_COLOR
    colors[moment.cells == OCCUPIED] = WALL
    raster = Image.fromarray(np.ascontiguousarray(colors.transpose(1, 0, 2)[::-1]))
    size = [max(round(n * moment.resolution * frame.pixels_per_m), 1) for n in moment.cells.shape]
    top = moment.origin[1] + moment.cells.shape[1] * moment.resolution
    [(x, y)] = frame.at(np.array([moment.origin[0], top]))
    resized = raster.resize((size[0], size[1]), Image.Resampling.NEAREST)
    page.paste(resized, (round(x), round(y)))


def _draw_objects(draw: ImageDraw.ImageDraw, view: MapView, frame: Frame, target: str) -> None:
    """Objects in their own mean colour, the target last and red."""
    half = 0.03 * frame.pixels_per_m
    for category in sorted(view.objects, key=lambda name: (name == target, name)):
        cloud = view.objects[category]
        points = cloud.points[on_this_floor(cloud.points, view), :2]
        if len(points):
            mean = tuple(int(c) for c in cloud.colors.mean(axis=0))
            color = TARGET if category == target else mean
            for x, y in frame.at(points[:: max(len(points) // 1500, 1)]):
                draw.rectangle((x - half, y - half, x + half, y + half), fill=color)


def _draw_thought(draw: ImageDraw.ImageDraw, decision: Decision, frame: Frame) -> None:
    """The memory's nodes and edges, the planned way and the waypoint."""
    if decision.memory is not None:
        _draw_memory(draw, decision.memory, decision.map_view.floor, frame)
    plan = frame.at(decision.path)
    for x, y in plan[::2]:
        draw.ellipse((x - 1.5, y - 1.5, x + 1.5, y + 1.5), fill=PURPLE)
    if decision.waypoint is not None:
        [(x, y)] = frame.at(decision.waypoint[:2])
        draw.ellipse((x - 6, y - 6, x + 6, y + 6), fill=PURPLE, outline=PAPER, width=2)


def _draw_memory(
    draw: ImageDraw.ImageDraw, memory: MemorySnapshot, floor: int, frame: Frame
) -> None:
    here = [node for node in memory.nodes if node.floor == floor]
    positions = np.array([node.position for node in here])
    spots = dict(zip((node.id for node in here), frame.at(positions), strict=True))
    for edge in memory.edges:
        if edge.source in spots and edge.target in spots:
            draw.line([spots[edge.source], spots[edge.target]], fill=NODE, width=2)
    font = ImageFont.load_default(size=11)
    for node_id, (x, y) in spots.items():
        draw.ellipse((x - 9, y - 9, x + 9, y + 9), fill=NODE, outline=PAPER, width=2)
        draw.text((x, y), str(node_id), fill=PAPER, font=font, anchor="mm")


def _draw_agent(draw: ImageDraw.ImageDraw, moment: Moment, frame: Frame) -> None:
    [(x, y)] = frame.at(moment.position[:2])
    turns = moment.yaw + np.array([0.0, 2.5, -2.5])
    tips = [(x + 13.0 * float(np.cos(a)), y - 13.0 * float(np.sin(a))) for a in turns]
    draw.polygon(tips, fill=PATH, outline=PAPER)


def _thought(camera: FilmCamera, moment: Moment) -> str:
    if moment.decision < 0 or camera.decisions[moment.decision].guidance is None:
        return ""
    guidance = camera.decisions[moment.decision].guidance
    assert guidance is not None
    if guidance.room_type == UNKNOWN_ROOM:
        return guidance.reason
    return f"in the {readable(guidance.room_type)}: {guidance.reason}"


def _write(page: Image.Image, first: str, second: str) -> None:
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(size=15)
    draw.text((8, MAP_SIDE + 5), first, fill=INK, font=font)
    small = ImageFont.load_default(size=12)
    while second and draw.textlength(second, font=small) > page.width - 16:
        second = second[:-5].rstrip() + " ..."
    draw.text((8, MAP_SIDE + 28), second, fill=(90, 98, 106), font=small)
