"""A noise model of goal confirmation: the prior, with a vision-language model's errors of sight.

The prior takes g_found from the detector's labels, so it can never contradict the detector. Here
g_found is a look of its own at the panorama, right or wrong in its own way: far and small targets
are overlooked, lookalikes are taken for the target, and now and then it is seen where nothing is.
Its errors are as persistent as the detector's (`perception.noisy`), and independent of them.
`docs/noise.md` gives the origin of every rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from toponav.categories import canonical
from toponav.config_model import ConfigModel
from toponav.errors import InputError
from toponav.memory.snapshot import UNKNOWN_ROOM
from toponav.perception.draws import Draws, key_of
from toponav.perception.eyesight import Eyesight
from toponav.perception.lookalikes import lookalikes
from toponav.perception.sightings import Sighting, SightLog, Witness
from toponav.reasoning.affinity import ROOM_TYPES
from toponav.reasoning.base import PanoramaView, Query, Reasoner, ReasonerContext, reasoners
from toponav.reasoning.prior import PriorReasoner
from toponav.reasoning.schema import Guidance

IMAGES_KEPT = 64
"""Images whose truth is remembered: more than the views of any panorama."""

IMAGINED_SIZE = 0.05
"""Relative size of a target that is seen where nothing is: any true sighting of note is larger."""

OWN_SEED = 0x5EEDE7E5
"""Keeps these draws apart from those of a detector with the same seed."""


class NoisyReasonerConfig(ConfigModel):
    """How often a model's look at a panorama errs; see docs/noise.md for where figures are from."""

    sight: Eyesight = Field(default_factory=lambda: Eyesight(half_size=0.06))
    """What is overlooked."""

    confusion: float = Field(default=0.5, ge=0.0)
    """Factor on the rates of `lookalikes`: context tells a model more than a crop tells a
    detector."""

    imagination: float = Field(default=0.003, ge=0.0, le=1.0)
    """Chance that the target is seen in a view which shows neither it nor anything like it."""

    room_error: float = Field(default=0.15, ge=0.0, le=1.0)
    """Chance that a room is given another type than the prior would give it."""


class NoisyReasoner:
    """Another reasoner's guidance, but with eyes of its own for the target."""

    def __init__(
        self,
        reasoner: Reasoner,
        sights: SightLog,
        seed: int,
        config: NoisyReasonerConfig | None = None,
    ) -> None:
        """Give `reasoner` eyes.

        Args:
            reasoner: Decides on everything but what is seen.
            sights: What the images truly show; must be told of every image of the episode.
            seed: Of the episode.
            config: The rates.
        """
        self._reasoner = reasoner
        self._sights = sights
        self._draws = Draws(seed ^ OWN_SEED)
        self._config = config or NoisyReasonerConfig()
        sights.keep(IMAGES_KEPT)

    def decide(self, query: Query) -> Guidance:
        """The other's guidance without the detector's word on the target, and an own look."""
        target = canonical(query.target)
        blind = replace(query, panorama=tuple(_without(target, view) for view in query.panorama))
        guidance = self._reasoner.decide(blind)
        room = self._room(guidance.room_type, query.panorama[0])
        sizes = [self._seen_size(target, view) for view in query.panorama]
        if max(sizes) == 0.0:
            return guidance.model_copy(update={"target_found": False, "room_type": room})
        direction = sizes.index(max(sizes))
        seen = {"target_found": True, "direction": direction, "room_type": room}
        return guidance.model_copy(update=seen)

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        """The other reasoner's."""
        return self._reasoner.room_affinity(target, rooms)

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        """The other reasoner's."""
        return self._reasoner.object_affinity(target, objects)

    def _seen_size(self, target: str, view: PanoramaView) -> float:
        """Relative size of the largest thing in a view that is taken for the target; 0 for none."""
        shown = self._sights.of(view.image)
        if shown is None:
            return 0.0
        sizes = (s.relative_size for s in shown.sightings if self._takes_for(target, s, shown))
        largest = max(sizes, default=0.0)
        imagined = self._draws.uniform("imagined", *shown.place, key_of(target))
        if largest == 0.0 and imagined < self._config.imagination:
            return IMAGINED_SIZE
        return largest

    def _takes_for(self, target: str, sighting: Sighting, shown: Witness) -> bool:
        """Whether an object is noticed, and taken for the target."""
        config, thing, category = self._config, sighting.instance.id, sighting.instance.category
        if category != target:
            rate = config.confusion * lookalikes(category).get(target, 0.0)
            keys = (thing, *sighting.side, key_of(target))
            if self._draws.uniform("lookalike", *keys) >= rate:
                return False
        sight = config.sight
        recall = sight.recall(sighting.relative_size, sighting.range_m, cut=sighting.cut)
        image = key_of(shown.place.tobytes())
        return sight.happens(self._draws, (thing,), sighting.side, image, recall)

    def _room(self, room: str, view: PanoramaView) -> str:
        """The room's type, or now and then another."""
        shown = self._sights.of(view.image)
        if shown is None or room == UNKNOWN_ROOM:
            return room
        x, y, z, _ = shown.place
        if self._draws.uniform("room", x, y, z) >= self._config.room_error:
            return room
        others = [name for name in ROOM_TYPES if name != room]
        return others[int(self._draws.uniform("other room", x, y, z) * len(others))]


def _without(target: str, view: PanoramaView) -> PanoramaView:
    """A view as the detector would describe it if it had never heard of the target."""
    return replace(view, seen=tuple(s for s in view.seen if canonical(s.label) != target))


@reasoners.register("noisy")
def _noisy(context: ReasonerContext) -> Reasoner:
    if context.sights is None:
        raise InputError("the noisy reasoner needs a simulator; choose another --reasoner")
    prior = PriorReasoner(context.config.prior)
    return NoisyReasoner(prior, context.sights, context.seed, context.config.noisy)
