"""The paper's Fig. 2: at the end of an empty corridor the agent turns back to a room it passed."""

from __future__ import annotations

from pathlib import Path

from small_house import small_config
from toponav.evaluation.recollection import Recollection
from toponav.evaluation.runner import SceneRunner
from toponav.scenes.loading import load_scene
from toponav.scenes.mesh import SceneEpisode

CORRIDOR = Path(__file__).resolve().parents[1] / "examples" / "scenes" / "corridor.json"
BEGIN, END = (1.2, 0.9, 0.0), (15.0, 0.9, 0.0)
DOOR_X = 8.6
"""Of the office, which the agent passes on its way to the plant at the end, metres."""


def test_the_agent_turns_back_to_the_room_that_it_passed() -> None:
    runner = SceneRunner(load_scene(str(CORRIDOR)), small_config(preset="default", max_steps=300))
    known = Recollection()
    passing = runner.run(runner.spec(0, SceneEpisode("plant", BEGIN, 0.0)), known=known)
    assert passing.succeeded
    assert passing.path_length < 1.1 * passing.shortest_path  # it did not go in
    assert known.knowledge is not None
    key_nodes = [n for n in known.knowledge.memory.nodes if abs(n.position[0] - DOOR_X) < 1.5]
    assert any(node.frontier_count for node in key_nodes)
    back = runner.run(runner.spec(1, SceneEpisode("chair", END, 0.0)), known=known)
    assert back.succeeded
    assert back.path_length < 1.3 * back.shortest_path  # only the store room lies as near
