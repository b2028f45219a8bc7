from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toponav.categories import DEFAULT_VOCABULARY, canonical
from toponav.reasoning import affinity
from toponav.reasoning.affinity import (
    ROOM_TYPES,
    UNHEARD_OF,
    canonical_room,
    companions_among,
    knows,
    presence,
    room_belief,
    room_prior,
    target_likelihood,
    target_presence,
)
from toponav.reasoning.knowledge import (
    COMPANIONS,
    CUE_WORDS,
    OFTEN,
    RARE,
    ROOM_SYNONYMS,
    ROOMS,
    SOMETIMES,
    USUAL,
)


def rooms_of(target: str, at_least: float = OFTEN) -> set[str]:
    values = target_presence(target)
    return {room for room, value in zip(ROOM_TYPES, values, strict=True) if value >= at_least}


def test_every_category_of_the_default_vocabulary_is_known():
    assert [category for category in DEFAULT_VOCABULARY if not knows(category)] == []


def test_table_names_are_canonical_and_listed_once_a_room():
    for room in ROOMS.values():
        names = f"{room.usual} {room.often} {room.sometimes}".split()
        assert len(names) == len(set(names))
        assert [name for name in names if canonical(name) != name] == []


def test_tables_refer_only_to_what_exists():
    assert set(ROOM_SYNONYMS.values()) | set(CUE_WORDS) <= set(ROOMS)
    assert not set(ROOM_SYNONYMS) & set(ROOMS)
    named = {name for one, others in COMPANIONS.items() for name in (one, *others.split())}
    assert [name for name in sorted(named) if not knows(name)] == []
    words = [word for words in CUE_WORDS.values() for word in words.split()]
    ambiguous = {word for word in words if words.count(word) > 1}
    assert ambiguous == set()


def test_presence_has_the_level_of_its_column():
    toilet = dict(zip(ROOM_TYPES, presence("toilet"), strict=True))
    chair = dict(zip(ROOM_TYPES, presence("chair"), strict=True))
    assert toilet["bathroom"] == USUAL
    assert toilet["kitchen"] == RARE
    assert (chair["kitchen"], chair["hallway"]) == (OFTEN, SOMETIMES)


def test_presence_cannot_be_changed_from_outside():
    presence("toilet")[:] = 0.0
    target_presence("toilet")[:] = 0.0
    assert presence("toilet").max() == target_presence("toilet").max() == USUAL


@pytest.mark.parametrize(
    ("name", "room"),
    [
        ("bedroom", "bedroom"),
        ("LivingRoom", "living room"),
        ("living_room", "living room"),
        ("The master bedroom", "bedroom"),
        ("bathroom 2", "bathroom"),
        ("kitchen_1", "kitchen"),
        ("walk-in closet", "closet"),
        ("TV room", "living room"),
        ("child's kids bedroom", "kids room"),
        ("WC", "bathroom"),
        ("unknown", None),
        ("", None),
        ("spaceship", None),
    ],
)
def test_room_names_of_models_and_data_sets(name, room):
    assert canonical_room(name) == room


@pytest.mark.parametrize(
    ("target", "rooms"),
    [
        ("toilet", {"bathroom"}),
        ("a toilet seat", {"bathroom"}),
        ("red office chair", rooms_of("chair")),
        ("chairs", rooms_of("chair")),
        ("coffee maker", {"kitchen"}),
        ("bottle of water", rooms_of("bottle")),
        ("treadmill", {"gym"}),
        ("child's crib", {"kids room"}),
    ],
)
def test_free_text_targets_point_to_sensible_rooms(target, rooms):
    assert rooms
    assert rooms_of(target) == rooms


def test_an_unheard_thing_is_wholly_where_its_cues_point():
    kitchen = dict(zip(ROOM_TYPES, target_presence("spice grinder"), strict=True))
    assert kitchen.pop("kitchen") == USUAL
    assert set(kitchen.values()) == {RARE}


def test_a_room_named_in_the_target_wins_over_common_knowledge():
    assert rooms_of("lamp in the garage", 0.5) == {"garage"}


def test_a_target_never_heard_of_may_be_anywhere():
    for target in ("xyzzy", "", "of the", "…"):
        assert target_presence(target).tolist() == [UNHEARD_OF] * len(ROOM_TYPES)


@given(st.text(max_size=40))
def test_any_text_gets_probabilities(text):
    values = target_presence(text)
    assert values.shape == (len(ROOM_TYPES),)
    assert (values > 0.0).all()
    assert (values < 1.0).all()


def test_belief_is_bayes_rule():
    # P(room | bed, chair) by hand, one room at a time.
    joint = room_prior() * presence("bed") * presence("chair")
    assert room_belief({"bed": 1.0, "chair": 1.0}) == pytest.approx(joint / joint.sum())


def test_belief_of_a_named_room_is_bayes_rule():
    likelihood = np.full(len(ROOM_TYPES), 0.2 / (len(ROOM_TYPES) - 1))
    likelihood[ROOM_TYPES.index("kitchen")] = 0.8
    joint = room_prior() * likelihood
    assert room_belief({}, "Kitchen") == pytest.approx(joint / joint.sum())


@given(
    st.dictionaries(st.sampled_from(DEFAULT_VOCABULARY), st.floats(0.0, 1.0), max_size=47),
    st.one_of(st.none(), st.text(max_size=10), st.sampled_from(ROOM_TYPES)),
)
def test_belief_is_a_distribution(evidence, room):
    belief = room_belief(evidence, room)
    assert belief.sum() == pytest.approx(1.0)
    assert (belief > 0.0).all()


def test_evidence_of_no_weight_and_unheard_objects_change_nothing():
    assert room_belief({"bed": 0.0, "xyzzy": 1.0}, "spaceship") == pytest.approx(room_prior())


def test_likelihood_sums_over_rooms_and_adds_companions():
    belief = room_prior()
    alone = float(belief @ presence("bed"))
    assert target_likelihood("bed", belief, ["oven"]) == pytest.approx(alone)
    beside = 1.0 - (1.0 - alone) * (1.0 - affinity.COMPANION_PRESENCE)
    assert target_likelihood("bed", belief, ["nightstand"]) == pytest.approx(beside)


def test_companions_are_read_both_ways_and_through_the_head_noun():
    assert companions_among("nightstand", ["bed", "oven"]) == ("bed",)
    assert companions_among("bed", ["sofa", "nightstand"]) == ("nightstand",)
    assert companions_among("wide wooden bed", ["nightstand", "lamp"]) == ("lamp", "nightstand")
    assert companions_among("xyzzy", ["bed"]) == ()
