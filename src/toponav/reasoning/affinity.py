"""Room-object and object-object affinities computed from `knowledge` (Section III-D and III-E).

Arrays over rooms are float64, (R,), in the order of `ROOM_TYPES`. All functions are pure.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.reasoning.knowledge import (
    COMPANIONS,
    CUE_WORDS,
    OFTEN,
    RARE,
    ROOM_SYNONYMS,
    ROOMS,
    SOMETIMES,
    USUAL,
    RoomContents,
)

Rooms = NDArray[np.float64]
"""(R,) one value a type of room."""

ROOM_TYPES = tuple(ROOMS)

LABEL_RELIABILITY = 0.8
"""Probability that a room type given by a model is right; the rest is spread over the others."""

COMPANION_PRESENCE = 0.5
"""Probability of finding a thing beside its companion, where the room says nothing of it."""

UNHEARD_OF = SOMETIMES
"""Presence in every room of a thing that no table knows: it may be anywhere."""

CUE_WEIGHT = 2.0 / 3.0
"""Share of a phrase's own cues ("lamp in the garage") against what is known of its head noun."""

_PREPOSITIONS = frozenset({"in", "on", "at", "by", "near", "of", "with", "from", "under", "next"})


def _presence_in(room: RoomContents, name: str) -> float:
    for names, probability in (
        (room.usual, USUAL),
        (room.often, OFTEN),
        (room.sometimes, SOMETIMES),
    ):
        if name in names.split():
            return probability
    return RARE


def _presence_table() -> dict[str, Rooms]:
    names = {
        name: None
        for room in ROOMS.values()
        for name in f"{room.usual} {room.often} {room.sometimes}".split()
    }
    return {name: np.array([_presence_in(room, name) for room in ROOMS.values()]) for name in names}


_PRESENCE = _presence_table()
_ROOM_INDEX = {room: index for index, room in enumerate(ROOM_TYPES)}
_CUE_ROOM = {word: room for room, words in CUE_WORDS.items() for word in words.split()}
_COMPANIONS = frozenset(
    frozenset({name, other}) for name, others in COMPANIONS.items() for other in others.split()
)


def room_prior() -> Rooms:
    """P(room): how common each type is; sums to 1."""
    frequency = np.array([room.frequency for room in ROOMS.values()])
    return np.asarray(frequency / frequency.sum())


def canonical_room(name: str) -> str | None:
    """The type of `ROOM_TYPES` that a free-text room name means, or None.

    The longest ending that is known decides: "the master bedroom" is a bedroom.
    """
    words = _words(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name))
    for start in range(len(words)):
        ending = " ".join(words[start:])
        for spelling in (ending, re.sub(r"\d+$", "", ending).strip()):
            room = ROOM_SYNONYMS.get(spelling, spelling)
            if room in ROOMS:
                return room
    return None


def knows(category: str) -> bool:
    """Whether the tables list this canonical category."""
    return category in _PRESENCE


def presence(category: str) -> Rooms:
    """P(a room of each type holds the category); the same everywhere if it is not in the tables."""
    known = _PRESENCE.get(category)
    return np.full(len(ROOM_TYPES), UNHEARD_OF) if known is None else known.copy()


@lru_cache(maxsize=256)
def _target_presence(target: str) -> tuple[float, ...]:
    category = canonical(target)
    if knows(category):
        return tuple(presence(category))
    phrase = _words(target)
    cut = next((i for i, word in enumerate(phrase) if i and word in _PREPOSITIONS), len(phrase))
    head, context = phrase[:cut], phrase[cut:]
    noun, modifiers = _head_noun(head)
    values = presence(noun)
    cues = [*_cues(modifiers), *_cues(context)]
    if not cues:
        return tuple(values)
    hint = np.mean(cues, axis=0)
    return tuple(hint if not knows(noun) else (1.0 - CUE_WEIGHT) * values + CUE_WEIGHT * hint)


def target_presence(target: str) -> Rooms:
    """P(a room of each type holds the target), for a category or free text.

    Free text that is no known category is read as an English noun phrase: its head noun is the
    longest known ending before a preposition ("red office chair" is a chair); its other words may
    point to rooms ("coffee maker", "lamp in the garage"). What says nothing is equally likely
    everywhere.
    """
    return np.array(_target_presence(target))


def room_belief(evidence: Mapping[str, float], room_type: str | None = None) -> Rooms:
    """P(room | evidence) by naive Bayes; sums to 1.

    Args:
        evidence: Seen categories, each with the weight of its evidence in [0, 1]: the exponent of
            its likelihood, so that 0 is as if it had not been seen.
        room_type: A model's word for the room, if any; ignored if it is no known type.
    """
    log_belief = np.log(room_prior())
    for category in sorted(evidence):
        log_belief += evidence[category] * np.log(presence(category))
    room = None if room_type is None else canonical_room(room_type)
    if room is not None:
        likelihood = np.full(len(ROOM_TYPES), (1.0 - LABEL_RELIABILITY) / (len(ROOM_TYPES) - 1))
        likelihood[_ROOM_INDEX[room]] = LABEL_RELIABILITY
        log_belief += np.log(likelihood)
    belief = np.exp(log_belief - log_belief.max())
    return np.asarray(belief / belief.sum())


def target_likelihood(target: str, belief: Rooms, objects: Iterable[str]) -> float:
    """P(the target is at a place of that room belief with those objects around), in (0, 1).

    Sums P(room) P(target | room), then adds what companions promise (noisy or).
    """
    by_room = float(belief @ target_presence(target))
    beside = COMPANION_PRESENCE if companions_among(target, objects) else 0.0
    return 1.0 - (1.0 - by_room) * (1.0 - beside)


def companions_among(target: str, objects: Iterable[str]) -> tuple[str, ...]:
    """The objects that stand beside the target, or are one, in sorted order."""
    category = canonical(target)
    if not knows(category):
        category = _head_noun(_words(target))[0]
    return tuple(
        sorted(
            name
            for name in set(objects)
            if name == category or frozenset({name, category}) in _COMPANIONS
        )
    )


def _words(text: str) -> list[str]:
    words = re.findall(r"[a-z0-9]+", text.lower().replace("'s", "s"))
    return [word for word in words if word not in {"a", "an", "the", "my"}]


def _head_noun(words: Sequence[str]) -> tuple[str, list[str]]:
    """The longest known category that ends the phrase, and the words before it.

    An unknown noun comes back as written, with all words as its modifiers: they may be cues.
    """
    for start in range(len(words)):
        ending = "_".join(words[start:])
        for spelling in (ending, ending.removesuffix("s")):
            if knows(canonical(spelling)):
                return canonical(spelling), list(words[:start])
    return "_".join(words), list(words)


def _cues(words: Sequence[str]) -> list[Rooms]:
    """What rooms, known objects and cue words in a phrase say of the room, longest match first."""
    cues: list[Rooms] = []
    start = 0
    while start < len(words):
        for stop in range(len(words), start, -1):
            cue = _cue(words[start:stop])
            if cue is not None:
                cues.append(cue)
                break
        else:
            stop = start + 1
        start = stop
    return cues


def _cue(words: Sequence[str]) -> Rooms | None:
    phrase = " ".join(words)
    room = ROOM_SYNONYMS.get(phrase, phrase)
    room = room if room in ROOMS else _CUE_ROOM.get(phrase, "")
    if room:
        values = np.full(len(ROOM_TYPES), RARE)
        values[_ROOM_INDEX[room]] = USUAL
        return values
    category = canonical(phrase)
    return presence(category) if knows(category) else None
