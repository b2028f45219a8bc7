"""What the node shows of a search: the grid, the path, the memory, the frontiers, the find."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from toponav.categories import readable
from toponav.geometry import Pose
from toponav.knowledge import RecallingAgent
from toponav.mapping.view import FREE, OCCUPIED, MapView
from toponav.memory.snapshot import EdgeView, NodeView
from toponav.robot.find import found_position
from toponav.robot.frame_sync import Instant
from toponav.robot.intent import Follow, Intent
from toponav.robot.ros2_import import import_ros
from toponav.robot.ros2_messages import write_pose
from toponav.robot.senses import Senses
from toponav.types import Agent

PERIOD_S = 1.0
"""Between two pictures, seconds."""

GREEN, ORANGE, BLUE = (0.1, 0.6, 0.2), (0.95, 0.55, 0.1), (0.2, 0.4, 0.9)


class Display:
    """Publishes the agent's map and memory, from snapshots that are made in the agent's thread."""

    def __init__(self, node: Any, senses: Senses, agent: Agent) -> None:
        """Publish on `node`."""
        nav, visual = import_ros("nav_msgs.msg"), import_ros("visualization_msgs.msg")
        geometry, qos = import_ros("geometry_msgs.msg"), import_ros("rclpy.qos")
        self._node, self._senses, self._agent = node, senses, agent
        self._nav, self._visual, self._geometry = nav, visual, geometry
        latched = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
        make = node.create_publisher
        self._grid = make(nav.OccupancyGrid, "toponav/grid", latched)
        self._path = make(nav.Path, "toponav/path", latched)
        self._graph = make(visual.MarkerArray, "toponav/graph", latched)
        self._frontiers = make(visual.MarkerArray, "toponav/frontiers", latched)
        self._find = make(geometry.PoseStamped, "toponav/found", latched)
        self.frame = "map"
        self.found: list[float] | None = None
        """Where the object was found, in the frame of the pose topic, metres."""
        self._view: MapView | None = None
        self._nodes: tuple[NodeView, ...] = ()
        self._edges: tuple[EdgeView, ...] = ()
        self._way: NDArray[np.float64] | None = None
        self._shown: MapView | None = None
        node.create_timer(PERIOD_S, self._publish)

    def acted(self, instant: Instant, intent: Intent | None) -> None:
        """Take a snapshot; called in the agent's thread."""
        del instant
        self._way = intent.way if isinstance(intent, Follow) else None
        if isinstance(self._agent, RecallingAgent):
            knowledge = self._agent.knowledge
            self._view = knowledge.semantic_map.view()
            self._nodes, self._edges = knowledge.memory.nodes, knowledge.memory.edges
            self._senses.guard.consult(self._view.grid)

    def tell_find(self, goal: str) -> None:
        """The search for `goal` is over: say where it is."""
        pose = self._senses.pose
        if self._view is None or pose is None:
            return
        position = found_position(self._view, goal, pose.translation)
        if position is None:
            return
        slam = self._senses.slam_from_world @ Pose.from_yaw(0.0, position)
        self.found = slam.translation.tolist()
        message = self._geometry.PoseStamped()
        self._stamp(message)
        write_pose(message.pose, slam)
        self._find.publish(message)

    def _publish(self) -> None:
        """Publish what has changed since the last time."""
        view = self._view
        if view is None or view is self._shown:
            return
        self._shown = view
        self._grid.publish(self._grid_message(view))
        self._path.publish(self._path_message(view.floor_z))
        self._frontiers.publish(self._frontier_markers(view))
        self._graph.publish(self._graph_markers(view))

    def _stamp(self, message: Any) -> None:
        message.header.frame_id = self.frame
        message.header.stamp = self._node.get_clock().now().to_msg()

    def _grid_message(self, view: MapView) -> Any:
        message, grid = self._nav.OccupancyGrid(), view.grid
        self._stamp(message)
        message.info.resolution = float(grid.resolution)
        message.info.width, message.info.height = grid.cells.shape
        origin = Pose.from_yaw(0.0, (*grid.origin, view.floor_z))
        write_pose(message.info.origin, self._senses.slam_from_world @ origin)
        cells = np.full(grid.cells.shape, -1, np.int8)
        cells[grid.cells == FREE] = 0
        cells[grid.cells == OCCUPIED] = 100
        message.data.frombytes(np.ascontiguousarray(cells.T).tobytes())
        return message

    def _path_message(self, floor_z: float) -> Any:
        message = self._nav.Path()
        self._stamp(message)
        for x, y in [] if self._way is None else self._way:
            pose = self._geometry.PoseStamped(header=message.header)
            write_pose(
                pose.pose, self._senses.slam_from_world @ Pose.from_yaw(0.0, (x, y, floor_z))
            )
            message.poses.append(pose)
        return message

    def _marker(self, kind: int, size: float, color: tuple[float, float, float]) -> Any:
        marker = self._visual.Marker(type=kind, action=0)
        self._stamp(marker)
        write_pose(marker.pose, self._senses.slam_from_world)
        marker.scale.x = marker.scale.y = marker.scale.z = size
        marker.color.r, marker.color.g, marker.color.b = color
        marker.color.a = 1.0
        return marker

    def _point(self, xyz: Any) -> Any:
        x, y, z = (float(v) for v in xyz)
        return self._geometry.Point(x=x, y=y, z=z)

    def _frontier_markers(self, view: MapView) -> Any:
        marker = self._marker(self._visual.Marker.CUBE_LIST, view.grid.resolution, ORANGE)
        marker.points = [self._point(p) for p in view.frontiers]
        return self._visual.MarkerArray(markers=[marker] if marker.points else [])

    def _graph_markers(self, view: MapView) -> Any:
        kinds, lift = self._visual.Marker, view.floor_z + 0.2
        nodes = {
            node.id: (*node.position, lift) for node in self._nodes if node.floor == view.floor
        }
        clear = kinds(action=kinds.DELETEALL)
        self._stamp(clear)
        spheres = self._marker(kinds.SPHERE_LIST, 0.25, GREEN)
        spheres.points = [self._point(p) for p in nodes.values()]
        lines = self._marker(kinds.LINE_LIST, 0.05, BLUE)
        lines.id = 1
        for edge in self._edges:
            if edge.source in nodes and edge.target in nodes:
                lines.points += [self._point(nodes[edge.source]), self._point(nodes[edge.target])]
        markers = [clear, spheres, lines] if lines.points else [clear, spheres]
        for node in self._nodes:
            if node.id in nodes:
                text = self._marker(kinds.TEXT_VIEW_FACING, 0.2, GREEN)
                text.id = 2 + node.id
                text.text = f"{node.id} {readable(node.room_type)}"
                x, y, z = nodes[node.id]
                write_pose(
                    text.pose,
                    self._senses.slam_from_world @ Pose.from_yaw(0.0, (x, y, z + 0.3)),
                )
                markers.append(text)
        return self._visual.MarkerArray(markers=markers)
