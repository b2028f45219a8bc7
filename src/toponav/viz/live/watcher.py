"""Logs an episode to Rerun: every step what the agent sees, every decision what it thinks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import ImageOps

from toponav.mapping.view import FREE, MapView, PointCloud
from toponav.memory.graph import TopologicalMemory
from toponav.policy.affordances import Affordances
from toponav.policy.decision import Decision
from toponav.types import Action, Observation
from toponav.viz.live import blueprint as at
from toponav.viz.live import entities
from toponav.viz.panorama import draw_panorama

STEP, DECISION = "step", "decision"
"""The timelines."""

MOST_POINTS = 20_000
"""Points logged of one cloud: beyond, every n-th, so that a large building stays fluent."""

MOST_PATH = 1_000
"""Points of the path logged at a step: what a step costs does not grow with those before it."""

IMAGE_WIDTH = 320
"""Images are logged at most this wide, in pixels: about 20 kB of RGB and 30 kB of depth a step."""

PANORAMA_SIZE = (980, 700)
"""All panoramas are logged at one size, pixels: the viewer plays compressed images as a video."""

LIFT_M = 0.03
"""What lies on the floor is drawn this much above it, so that nothing flickers."""

LIFT = np.array([0.0, 0.0, LIFT_M])


class LiveWatcher:
    """A step observer and a decision listener; it never steers.

    What is kept grows slowly: a cloud is logged again only when it has changed, at most once a
    decision and thinned to `MOST_POINTS`; images are compressed.
    """

    def __init__(self, rr: Any, stream: Any, target: str) -> None:
        """Log to `stream`, a recording of Rerun's module `rr`, a search for `target`."""
        self._rr = rr
        self._stream = stream
        self._target = target
        self._positions: list[NDArray[np.float64]] = []
        self._walked_m = 0.0
        self._collisions = 0
        self._clouds: dict[str, int] = {}
        stream.set_time(STEP, sequence=0)
        stream.set_time(DECISION, sequence=0)
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def on_step(self, observation: Observation, action: Action) -> None:
        """Log the camera with its images, the path so far and how far it is."""
        rr, log = self._rr, self._stream.log
        self._stream.set_time(STEP, sequence=observation.step)
        position = observation.world_from_base.translation
        if self._positions:
            self._walked_m += float(np.linalg.norm(position - self._positions[-1]))
        self._collisions += observation.collided
        moved = not self._positions or not np.array_equal(position, self._positions[-1])
        if moved:
            self._positions.append(position)
            kept = self._positions[entities.thin(len(self._positions), MOST_PATH)]
            path = np.array([*kept, position]) + LIFT
            log(f"{at.AGENT}/path", rr.LineStrips3D([path], colors=[[25, 113, 194]]))
        log(f"{at.AGENT}/body", rr.Points3D([position], radii=0.15, colors=[[25, 113, 194]]))
        self._log_camera(observation)
        log(f"{at.METRICS}/walked_m", rr.Scalars(self._walked_m))
        log(f"{at.METRICS}/collisions", rr.Scalars(self._collisions))
        log(f"{at.AGENT}/action", rr.TextLog(action.name.lower()))

    def on_decision(self, decision: Decision) -> None:
        """Log the map, the memory, what the reasoner said and where the agent goes."""
        rr, log = self._rr, self._stream.log
        self._stream.set_time(STEP, sequence=decision.step)
        self._stream.set_time(DECISION, sequence=decision.index)
        self._log_map(decision.map_view)
        if decision.affordances is not None:
            self._log_affordances(decision.affordances)
        else:
            log(at.AFFORDANCES, rr.Clear(recursive=True))
        self._log_plan(decision)
        self._log_memory(decision)
        if decision.panorama:
            sheet = draw_panorama(decision.panorama, decision.guidance, self._target)
            page = ImageOps.pad(sheet, PANORAMA_SIZE, color="white")
            log(at.PANORAMA, rr.Image(np.asarray(page)).compress(jpeg_quality=80))
        text = entities.answer_text(decision, self._target)
        log(at.ANSWER, rr.TextDocument(text, media_type="text/plain"))
        log(at.LOG, rr.TextLog(" | ".join(text.splitlines())))

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Log the last map."""
        del memory
        if map_view is not None:
            self._log_map(map_view)

    def _log_camera(self, observation: Observation) -> None:
        rr, log = self._rr, self._stream.log
        camera, pose = observation.intrinsics, observation.world_from_camera
        step = max(-(-camera.width // IMAGE_WIDTH), 1)
        rgb = np.ascontiguousarray(observation.rgb[::step, ::step])
        log(at.CAMERA, rr.Transform3D(translation=pose.translation, mat3x3=pose.rotation))
        log(
            at.CAMERA,
            rr.Pinhole(
                resolution=[rgb.shape[1], rgb.shape[0]],
                focal_length=[camera.fx / step, camera.fy / step],
                principal_point=[camera.cx / step, camera.cy / step],
                camera_xyz=rr.ViewCoordinates.RDF,
                image_plane_distance=0.6,
            ),
        )
        log(at.RGB, rr.Image(rgb).compress(jpeg_quality=80))
        log(
            at.DEPTH,
            rr.EncodedDepthImage(
                entities.depth_png(observation.depth, step),
                media_type="image/png", meter=entities.MILLIMETRES, depth_range=[0.0, 5000.0],
            ),
        )  # fmt: skip

    def _log_map(self, view: MapView) -> None:
        rr, log = self._rr, self._stream.log
        self._log_cloud(f"{at.MAP}/scene", view.scene, None)
        for category, cloud in view.objects.items():
            is_target = category == self._target
            color = (224, 49, 49) if is_target else entities.category_color(category)
            self._log_cloud(f"{at.MAP}/objects/{entities.path_name(category)}", cloud, color)
        cells, colors = entities.grid_cells(view.grid, view.floor_z)
        half = view.grid.resolution / 2.0
        log(f"{at.MAP}/occupancy", rr.Points3D(cells, colors=colors, radii=half))
        lifted = view.frontiers + LIFT
        log(f"{at.MAP}/frontiers", rr.Points3D(lifted, colors=[[240, 140, 0]], radii=half))
        free_m2 = np.count_nonzero(view.grid.cells == FREE) * view.grid.resolution**2
        log(f"{at.METRICS}/free_m2", rr.Scalars(free_m2))
        log(f"{at.METRICS}/frontier_points", rr.Scalars(len(view.frontiers)))

    def _log_cloud(
        self, entity: str, cloud: PointCloud, color: tuple[int, int, int] | None
    ) -> None:
        """Log a cloud, in its own colours without one, if it holds more than when last logged."""
        if self._clouds.get(entity) == len(cloud):
            return
        self._clouds[entity] = len(cloud)
        rows = entities.thin(len(cloud), MOST_POINTS)
        colors = cloud.colors[rows] if color is None else [color]
        points = cloud.points[rows]
        self._stream.log(entity, self._rr.Points3D(points, colors=colors, radii=0.02))

    def _log_affordances(self, affordances: Affordances) -> None:
        rows = entities.thin(len(affordances.points), MOST_POINTS)
        points = affordances.points[rows] + np.array([0.0, 0.0, LIFT_M], np.float32)
        values = {**affordances.terms, "safe": affordances.safe, "total": affordances.total}
        for name, term in values.items():
            colors = entities.heat(np.asarray(term, np.float64)[rows])
            entity = f"{at.AFFORDANCES}/{name}"
            self._stream.log(entity, self._rr.Points3D(points, colors=colors, radii=0.03))

    def _log_plan(self, decision: Decision) -> None:
        rr, log = self._rr, self._stream.log
        height = decision.map_view.floor_z + 2.0 * LIFT_M
        purple = [[174, 62, 201]]
        way = entities.at_height(decision.path, height)
        log(f"{at.PLAN}/path", rr.LineStrips3D([way] if len(way) else [], colors=purple))
        goals = np.zeros((0, 2)) if decision.waypoint is None else decision.waypoint[None, :2]
        places = entities.at_height(goals, height)
        labels = ["waypoint"] * len(places)
        log(f"{at.PLAN}/waypoint", rr.Points3D(places, radii=0.12, colors=purple, labels=labels))

    def _log_memory(self, decision: Decision) -> None:
        memory = decision.memory
        if memory is None:
            return
        rr, log, view = self._rr, self._stream.log, decision.map_view
        height = view.floor_z + 0.3
        here = {node.id: node for node in memory.nodes if node.floor == view.floor}
        places = entities.at_height(np.array([n.position for n in here.values()]), height)
        spots = dict(zip(here, places, strict=True))
        colors = [[25, 25, 25] if k == memory.current else [47, 158, 68] for k in here]
        labels = [entities.node_label(node) for node in here.values()]
        nodes = rr.Points3D(places, radii=0.12, colors=colors, labels=labels)
        log(f"{at.GRAPH}/nodes", nodes)
        strips = [
            [spots[edge.source], spots[edge.target]]
            for edge in memory.edges
            if edge.source in spots and edge.target in spots
        ]
        log(f"{at.GRAPH}/edges", rr.LineStrips3D(strips, colors=[[47, 158, 68]], radii=0.02))
        log(at.MEMORY_TEXT, rr.TextDocument(memory.text, media_type="text/plain"))
        log(f"{at.METRICS}/memory_nodes", rr.Scalars(len(memory.nodes)))
