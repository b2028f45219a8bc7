"""What a single picture of a search needs, gathered while it runs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from toponav.categories import readable
from toponav.errors import InputError
from toponav.mapping.view import MapView
from toponav.memory.graph import TopologicalMemory
from toponav.policy.decision import Decision
from toponav.types import Action, Observation
from toponav.viz.topdown import TopDownPicture


@dataclass
class StillCamera:
    """Watches an episode; then makes the picture of any of its decisions, or of its end."""

    positions: list[NDArray[np.float64]] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    map_view: MapView | None = None
    memory: TopologicalMemory | None = None

    def on_step(self, observation: Observation, action: Action) -> None:
        """Remember the path."""
        del action
        self.positions.append(observation.world_from_base.translation)

    def on_decision(self, decision: Decision) -> None:
        """Remember a decision."""
        self.decisions.append(decision)

    def on_close(self, map_view: MapView | None, memory: TopologicalMemory | None) -> None:
        """Remember the last map."""
        self.map_view, self.memory = map_view, memory

    def last(self, target: str, title: str, subtitle: str) -> TopDownPicture:
        """The end of the search.

        Raises:
            InputError: The method keeps no map.
        """
        if self.map_view is None:
            raise InputError("this method keeps no map that could be drawn")
        path = np.array(self.positions)
        return TopDownPicture(self.map_view, path, self.memory, target, title, subtitle)

    def at(self, index: int, target: str, scene: str) -> TopDownPicture:
        """A decision: the map, the memory, the waypoint and the way to it as they were.

        Raises:
            InputError: There is no such decision.
        """
        decision = self._decision(index)
        snapshot = decision.memory
        memory = None
        if snapshot is not None:
            next_id = max((node.id for node in snapshot.nodes), default=0) + 1
            memory = TopologicalMemory.from_parts(
                snapshot.nodes, snapshot.edges, snapshot.history, next_id
            )
        guidance = decision.guidance
        return TopDownPicture(
            map_view=decision.map_view,
            trajectory=np.array(self.positions[: decision.step + 1]).reshape(-1, 3),
            memory=memory,
            target=target,
            title=f"searching for {readable(target)} in {scene}: decision {decision.index}",
            subtitle=f"step {decision.step}. {'' if guidance is None else guidance.reason}",
            waypoint=decision.waypoint,
            plan=decision.path,
        )

    def panorama(self, index: int | None) -> Decision:
        """A decision with its panorama; the last that has one without an index.

        Raises:
            InputError: There is none.
        """
        if index is not None:
            decision = self._decision(index)
            if decision.panorama:
                return decision
            raise InputError(f"decision {index} was made without a panorama")
        for decision in reversed(self.decisions):
            if decision.panorama:
                return decision
        raise InputError("no decision of this search was made on a panorama")

    def _decision(self, index: int) -> Decision:
        if not 0 <= index < len(self.decisions):
            raise InputError(
                f"--decision {index}: the search has decisions 0 to {len(self.decisions) - 1}"
                if self.decisions
                else "the search has no decisions"
            )
        return self.decisions[index]
