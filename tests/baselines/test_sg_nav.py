"""SG-Nav: what the best group adds to ESC's score, and how often a target must be seen."""

from __future__ import annotations

import numpy as np
import pytest
from searches import Blind, Log, named, search
from words import Words

from drawn_map import clusters_from, detections_of, drawn_map, observation_at, reach_from
from small_house import small_config
from toponav.baselines.object_groups import ObjectGroup
from toponav.baselines.sg_nav import OTHER_SIGHTINGS, SIGHTINGS, SgNavAgent, group_gain
from toponav.policy.affordances import Phase
from toponav.policy.goal import GoalTracker
from toponav.types import Action

HALL = drawn_map(
    "##############",
    "#............#",
    " ............ ",
    "#............#",
    "##############",
    enlarged=5,
)
MIDDLE = (18, 13, 22, 17)


def agent(words: dict[str, float], goal: str = "sofa") -> SgNavAgent:
    made = SgNavAgent(Blind(), Words(words), small_config().navigator, Log())
    made.reset(goal)
    return made


def test_a_group_adds_one_over_the_distance_within_its_radius() -> None:
    group = ObjectGroup(("bed",), np.array([1.0, 1.0]))
    cells = np.array([(1.0, 2.0), (1.0, 1.0), (1.0, 1.25), (2.6, 1.0), (2.7, 1.0), (4.0, 4.0)])
    np.testing.assert_allclose(group_gain(cells, group), [1.0, 2.0, 2.0, 1 / 1.6, 0.0, 0.0])


def test_only_the_best_group_counts() -> None:
    here = (3.5, 1.25)
    clusters, reach = clusters_from(HALL, here), reach_from(HALL, here)
    cells = np.concatenate([cluster.cells for cluster in clusters])
    searching = agent({"bed": 0.9, "rug": 0.5})
    for x, label in ((-1.0, "rug"), (3.5, "bed")):  # 2 m ahead: at x = 1 and x = 5.5
        searching._perceive(observation_at(x, 1.25), detections_of({label: MIDDLE}, [1.0]), HALL)
    distance = searching._distances(reach).at(cells)
    plain = super(SgNavAgent, searching)._scores(cells, distance, HALL)
    gain = searching._scores(cells, distance, HALL) - plain
    left = cells[:, 0] < 3.0
    np.testing.assert_allclose(gain[left], 0.0, atol=1e-12)
    assert gain[~left].min() > 0.6


@pytest.mark.parametrize("goal", ["chair", "bed", "sofa", "toilet"])
def test_a_target_is_believed_after_as_many_sightings_as_its_category_needs(
    goal: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(GoalTracker, "is_mapped", lambda *_: True)
    searching = agent({}, goal)
    needed = SIGHTINGS.get(goal, OTHER_SIGHTINGS)
    for sightings in range(needed + 1):
        assert searching._believes_in_target(HALL) == (sightings >= needed)
        seen = detections_of({goal: MIDDLE, "rug": MIDDLE}, [1.0, 1.0])
        searching._perceive(observation_at(0.0, 0.0), seen, HALL)


def test_it_finds_the_target() -> None:
    log = search(named("sg_nav"))
    assert log.actions[-1] is Action.STOP
    assert log.distance_to_goal < 0.1
    assert log.decisions[-1].phase is Phase.TARGET_ACQUISITION
