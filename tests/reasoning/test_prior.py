from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from toponav.memory.snapshot import UNKNOWN_ROOM, EdgeView, MemorySnapshot, NodeView
from toponav.reasoning.base import PanoramaView, Query, SeenObject
from toponav.reasoning.prior import (
    PriorConfig,
    PriorReasoner,
    classify_room,
    score_places,
)

CONFIG = PriorConfig()
IMAGE = np.zeros((1, 1, 3), np.uint8)


def node(
    node_id: int,
    x: float,
    y: float = 0.0,
    room: str = UNKNOWN_ROOM,
    objects: tuple[str, ...] = (),
    frontiers: int = 10,
) -> NodeView:
    return NodeView(node_id, (x, y), 0, objects, room, frontiers, 1)


def view(
    *seen: SeenObject, bearing: float = 0.0, frontiers: int = 0, area: float = 0.0
) -> PanoramaView:
    return PanoramaView(IMAGE, bearing, seen, area, frontiers)


def star(*nodes: NodeView, history: tuple[int, ...] = (1,)) -> MemorySnapshot:
    """The agent stands at node 1, which every other node is joined to."""
    edges = tuple(
        EdgeView(1, other.id, length, length)
        for other in nodes[1:]
        for length in [math.dist(nodes[0].position, other.position)]
    )
    return MemorySnapshot(nodes, edges, 1, history, "")


def decide(target: str, memory: MemorySnapshot, *views: PanoramaView):
    return PriorReasoner().decide(Query(target, memory, views or (view(),)))


def hide(memory: MemorySnapshot, **hidden: object) -> MemorySnapshot:
    return replace(memory, nodes=tuple(replace(n, **hidden) for n in memory.nodes))


HERE = node(1, 0.0, room="hallway", frontiers=0)
"""Where the agent stands, fully seen."""


@pytest.mark.parametrize(
    ("target", "place"),
    [("toilet", 2), ("fridge", 3), ("bed", 4), ("washing machine", 5), ("coffee maker", 3)],
)
def test_targets_are_sought_in_their_rooms(target, place):
    memory = star(
        HERE,
        node(2, 3.0, room="bathroom"),
        node(3, -3.0, room="kitchen"),
        node(4, 0.0, 3.0, room="Master Bedroom"),
        node(5, 0.0, -3.0, room="laundry"),
    )
    assert decide(target, memory).node_id == place


def test_without_rooms_the_choice_changes():
    memory = star(HERE, node(2, 3.0, room="kitchen", frontiers=12), node(3, 3.0, room="bathroom"))
    assert decide("toilet", memory).node_id == 3
    assert decide("toilet", hide(memory, room_type=UNKNOWN_ROOM)).node_id == 2


def test_without_objects_the_choice_changes():
    memory = star(
        HERE,
        node(2, 3.0, objects=("oven", "fridge"), frontiers=12),
        node(3, 3.0, objects=("sink", "bathtub", "towel")),
    )
    assert decide("toilet", memory).node_id == 3
    assert decide("toilet", hide(memory, objects=())).node_id == 2


def test_without_frontiers_the_choice_changes():
    memory = star(HERE, node(2, 3.0, frontiers=0), node(3, 4.0, frontiers=30))
    assert decide("toilet", memory).node_id == 3
    assert decide("toilet", hide(memory, frontier_count=0)).node_id == 2


def test_a_place_without_frontiers_is_pointless_whatever_its_room():
    memory = star(
        HERE, node(2, 1.0, room="bathroom", frontiers=0), node(3, 15.0, room="garage", frontiers=1)
    )
    assert decide("toilet", memory).node_id == 3


def test_companions_attract_within_the_same_room_type():
    memory = star(
        HERE,
        node(2, 3.0, room="living room", objects=("bookshelf",)),
        node(3, 3.0, room="living room", objects=("tv_stand",)),
    )
    assert decide("tv_monitor", memory).node_id == 3


def test_nearer_is_better_along_edges_not_as_the_crow_flies():
    memory = star(HERE, node(2, 2.0), node(3, 3.0))
    assert decide("bed", memory).node_id == 2
    detour = replace(memory, edges=(EdgeView(1, 2, 9.0, 9.0), EdgeView(1, 3, 3.0, 3.0)))
    assert decide("bed", detour).node_id == 3


def test_recent_and_frequent_visits_are_avoided():
    memory = star(HERE, node(2, 2.0), node(3, 2.5))
    assert decide("bed", memory).node_id == 2
    assert decide("bed", replace(memory, history=(1, 2, 1, 2, 1))).node_id == 3
    long_ago = (1, 2, *[1] * 20)
    assert decide("bed", replace(memory, history=long_ago)).node_id == 2


def test_the_arrival_that_led_here_is_no_revisit():
    memory = star(node(1, 0.0), node(2, 2.0))
    (here, _) = score_places(Query("bed", memory, (view(),)), UNKNOWN_ROOM, CONFIG)
    assert here.novelty == 1.0


def test_scores_are_the_product_of_their_parts():
    memory = star(HERE, node(2, 10.0, room="bathroom", objects=("sink",)), history=(2, 1))
    here, there = score_places(Query("toilet", memory, (view(),)), UNKNOWN_ROOM, CONFIG)
    assert (there.openness, there.nearness, there.novelty) == (0.5, 0.5, 1 / 1.5)
    assert there.total == pytest.approx(math.sqrt(there.likelihood) * 0.25 / 1.5)
    assert here.total == 0.0


def test_ties_go_to_the_lowest_id_and_the_first_view():
    memory = star(HERE, node(2, 3.0), node(3, -3.0))
    guidance = decide("bed", memory, view(bearing=1.5), view(bearing=-1.5))
    assert (guidance.node_id, guidance.direction) == (2, 0)


def test_unconnected_places_count_by_straight_distance():
    memory = replace(star(HERE, node(2, 8.0), node(3, 2.0)), edges=())
    assert decide("bed", memory).node_id == 3


def seen(label: str, score: float = 0.9, range_m: float = 1.5) -> SeenObject:
    return SeenObject(label, score, range_m)


@pytest.mark.parametrize(
    ("labels", "room"),
    [
        (["bed", "nightstand"], "bedroom"),
        (["toilet"], "bathroom"),
        (["shower", "sink"], "bathroom"),
        (["refrigerator", "oven"], "kitchen"),
        (["couch", "tv"], "living room"),
        (["car", "bicycle"], "garage"),
        (["washing_machine", "dryer", "laundry_basket"], "laundry room"),
        (["table", "chair", "picture", "plant", "vase"], "dining room"),
        (["desk", "chair", "laptop", "printer", "book"], "office"),
        (["chair"], UNKNOWN_ROOM),
        ([], UNKNOWN_ROOM),
        (["xyzzy"], UNKNOWN_ROOM),
    ],
)
def test_rooms_are_recognised_by_what_is_seen(labels, room):
    assert classify_room([view(*(seen(label) for label in labels))], CONFIG) == room
    spread = [view(seen(label)) for label in labels] or [view()]
    assert classify_room(spread, CONFIG) == room


def test_far_objects_say_little_about_the_room_around():
    kitchen_behind_a_door = view(seen("fridge", range_m=8.0), seen("oven", range_m=8.0))
    assert classify_room([kitchen_behind_a_door], CONFIG) == UNKNOWN_ROOM
    assert classify_room([view(seen("fridge", range_m=math.inf))], CONFIG) == UNKNOWN_ROOM
    near = view(seen("toilet"), seen("towel"))
    assert classify_room([kitchen_behind_a_door, near], CONFIG) == "bathroom"


def test_many_sightings_of_one_category_count_once():
    one = classify_room([view(seen("chair"))], CONFIG)
    assert classify_room([view(*[seen("chair")] * 40)] * 12, CONFIG) == one == UNKNOWN_ROOM


def test_the_room_is_answered_even_when_the_memory_hides_rooms():
    memory = hide(star(HERE, node(2, 3.0)), room_type=UNKNOWN_ROOM, objects=())
    guidance = decide("bed", memory, view(seen("toilet"), seen("sink")))
    assert guidance.room_type == "bathroom"


def test_the_room_just_seen_counts_for_the_current_node():
    memory = star(node(1, 0.0), node(2, 1.0, frontiers=30))
    in_a_bathroom = view(seen("sink"), seen("towel"), seen("shower"))
    assert decide("toilet", memory).node_id == 2
    assert decide("toilet", memory, in_a_bathroom).node_id == 1
    named = replace(memory, nodes=(replace(memory.nodes[0], room_type="garage"), memory.nodes[1]))
    assert decide("toilet", named, in_a_bathroom).node_id == 2


def test_the_target_in_sight_beats_every_opening():
    guidance = decide(
        "potted plant",
        star(HERE, node(2, 3.0)),
        view(seen("plant", 0.3), frontiers=50),
        view(frontiers=500, area=50.0),
        view(seen("plant", 0.8, 4.0)),
    )
    assert guidance.direction == 2
    assert guidance.target_found


def test_a_doubtful_sighting_points_the_way_but_is_not_found():
    guidance = decide(
        "bed", star(HERE), view(frontiers=50), view(seen("bed", CONFIG.found_score - 0.01))
    )
    assert (guidance.direction, guidance.target_found) == (1, False)


def test_another_category_is_never_found():
    assert not decide("bed", star(HERE), view(seen("sofa", 1.0))).target_found


def test_views_with_telling_objects_beat_larger_openings():
    bathroom_door = view(seen("sink"), seen("towel"), frontiers=10)
    assert decide("toilet", star(HERE), view(frontiers=20), bathroom_door).direction == 1
    assert decide("toilet", star(HERE), view(frontiers=20), view(frontiers=10)).direction == 0


def test_without_other_cues_frontiers_then_floor_decide():
    wall, floor, frontier = view(), view(area=6.0), view(frontiers=10)
    assert decide("bed", star(HERE), wall, floor).direction == 1
    assert decide("bed", star(HERE), wall, floor, frontier).direction == 2


def test_the_view_towards_the_chosen_place_is_preferred():
    memory = star(HERE, node(2, 0.0, 4.0))
    views = [view(bearing=angle, frontiers=10) for angle in (0.0, -math.pi / 2, math.pi / 2)]
    assert decide("bed", memory, *views).direction == 2


def test_the_reason_is_one_telling_sentence():
    memory = star(HERE, node(2, 3.0, room="kitchen", objects=("oven", "sink"), frontiers=12))
    reason = decide("fridge", memory).reason
    assert reason == (
        "kitchen place 2 is 90% likely to hold the fridge, near oven, "
        "with 12 frontier points left to see"
    )
    in_sight = decide("fridge", memory, view(seen("fridge"))).reason
    assert in_sight.endswith("; view 0 shows the fridge")


def test_names_from_outside_cannot_break_the_reason():
    memory = star(node(1, 0.0, room="kit\nchen", objects=("oven",)))
    assert len(decide("fri\u2028dge", memory).reason.splitlines()) == 1


def test_affinities_are_probabilities_and_know_what_goes_with_what() -> None:
    prior = PriorReasoner()
    rooms = prior.room_affinity("bed", ["bedroom", "kitchen", "Master Bedroom", "no such room"])
    assert rooms[0] == rooms[2] > rooms[3] > rooms[1] >= 0.0
    objects = prior.object_affinity("bed", ["bed", "nightstand", "oven", "what's it"])
    assert objects[0] == 1.0 > objects[1] > objects[3] > objects[2] > 0.0
    assert prior.room_affinity("bed", []).shape == prior.object_affinity("bed", []).shape == (0,)
