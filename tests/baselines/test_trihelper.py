"""TriHelper's three helpers, one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from searches import Blind, Log, named, search
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.l3mvn import REPLAN_STEPS, L3mvnAgent
from toponav.baselines.trihelper import DETOUR_STEPS, QUESTION_STEPS, TRAPPED_BUMPS, TriHelperAgent
from toponav.types import Action

HALL = drawn_map(
    "##############",
    "#............#",
    "#............ ",
    " ............ ",
    "#............#",
    "##############",
    enlarged=5,
)
MIDDLE = (18, 13, 22, 17)


def agent(words: dict[str, float] | None = None, seed: int = 0) -> TriHelperAgent:
    made = TriHelperAgent(Blind(), Words(words or {}), small_config().navigator, seed, Log())
    made.reset("sofa")
    return made


def test_after_six_blocked_steps_it_turns_and_steps_in_turn_until_a_step_succeeds(
    monkeypatch,
) -> None:
    monkeypatch.setattr(L3mvnAgent, "act", lambda *_: Action.MOVE_FORWARD)
    searching = agent()
    blocked = replace(observation_at(0.0, 0.0), collided=True)
    assert searching.act(observation_at(0.0, 0.0)) is Action.MOVE_FORWARD
    before = [searching.act(blocked) for _ in range(TRAPPED_BUMPS - 1)]
    assert before == [Action.MOVE_FORWARD] * (TRAPPED_BUMPS - 1)
    trapped = [searching.act(blocked) for _ in range(4)]
    assert trapped == [Action.TURN_LEFT, Action.MOVE_FORWARD] * 2
    assert searching.act(observation_at(0.3, 0.0)) is Action.MOVE_FORWARD


def test_a_repeated_goal_close_by_gives_way_to_a_random_frontier_for_twice_the_steps() -> None:
    here = (4.3, 1.5)  # 2.2 m from the right end
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)

    def walk(seed: int) -> list[tuple[float, ...]]:
        searching, chosen = agent(seed=seed), []
        for step in (0, REPLAN_STEPS, REPLAN_STEPS + DETOUR_STEPS):
            last = observation_at(*here, step=step - 1)
            assert step == 0 or searching._replans(replace(last, step=step), HALL)
            assert step == 0 or not searching._replans(last, HALL)
            now = observation_at(*here, step=step)
            chosen.append(tuple(searching._choose(clusters, reach, now, HALL)))
        return chosen

    walks = [walk(seed) for seed in range(12)]
    assert walk(3) == walks[3]
    cells = {tuple(cell) for cluster in clusters for cell in cluster.cells[cluster.reachable]}
    detours = [path for path in walks if path[1] != path[0]]  # else it is repeated once more
    assert all(path[0] == path[2] for path in detours)
    assert {path[1][:2] for path in walks} <= cells
    assert len({path[1] for path in detours}) > 3


def test_a_repeated_goal_far_away_is_gone_to() -> None:
    here = (3.0, 1.5)
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)
    searching = agent()
    first, second = (
        searching._choose(clusters, reach, observation_at(*here, step=step), HALL)
        for step in (0, REPLAN_STEPS)
    )
    np.testing.assert_array_equal(first, second)


def test_detections_are_struck_until_one_is_confirmed_or_the_questions_end() -> None:
    sofa = {"sofa": MIDDLE, "rug": MIDDLE}
    searching = agent()
    assert searching._accepted(detections_of(sofa, [0.4, 1.0])).labels == ("rug",)
    assert searching._accepted(detections_of(sofa, [0.6, 1.0])).labels == ("sofa", "rug")
    assert searching._accepted(detections_of(sofa, [0.4, 1.0])).labels == ("sofa", "rug")
    late = agent()
    nothing = detections_of({}, [])
    for _ in range(QUESTION_STEPS - 1):
        late._accepted(nothing)
    assert late._accepted(detections_of(sofa, [0.4, 1.0])).labels == ("rug",)
    assert late._accepted(detections_of(sofa, [0.4, 1.0])).labels == ("sofa", "rug")


def test_it_finds_the_target() -> None:
    log = search(named("trihelper"))
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal < 0.1
