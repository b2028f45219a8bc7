"""The paper's brain: a vision-language model behind the Reasoner seam (Section III-E)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from toponav.categories import canonical
from toponav.reasoning.base import Query
from toponav.reasoning.schema import Guidance
from toponav.reasoning.vlm.affinity_prompt import affinity_prompt
from toponav.reasoning.vlm.answers import parse_affinities, parse_answer, parse_guidance, room_name
from toponav.reasoning.vlm.guidance_prompt import ROOM_ONLY, guidance_prompt, room_prompt
from toponav.reasoning.vlm.model_client import ModelClient
from toponav.reasoning.vlm.prompt import Prompt, PromptConfig


class VlmReasoner:
    """Asks a model and checks what it says; it fails where the model does."""

    def __init__(self, client: ModelClient, config: PromptConfig) -> None:
        """Ask through `client`, as `config` says."""
        self._client = client
        self._config = config
        self._affinities: dict[tuple[str, str, str], float] = {}

    def decide(self, query: Query) -> Guidance:
        """The model's guidance.

        Raises:
            ReasonerError: No usable answer could be had.
        """
        room = self._room(query) if self._config.two_calls else None
        prompt = guidance_prompt(query, self._config)
        return self._client.ask(prompt, partial(parse_guidance, prompt=prompt, room=room))

    def room_affinity(self, target: str, rooms: Sequence[str]) -> NDArray[np.float64]:
        """What the model says of rooms; each is asked of once."""
        return self._affinity(target, rooms, "rooms")

    def object_affinity(self, target: str, objects: Sequence[str]) -> NDArray[np.float64]:
        """What the model says of objects, and 1 for the target itself; each is asked of once."""
        values = self._affinity(target, objects, "objects")
        own = [canonical(name) == canonical(target) for name in objects]
        return np.where(own, 1.0, values)

    def _room(self, query: Query) -> str:
        """R, by a call of its own."""
        prompt = room_prompt(query.panorama, self._config)
        return self._client.ask(prompt, partial(_parse_room, prompt=prompt))

    def _affinity(
        self, target: str, names: Sequence[str], kind: Literal["rooms", "objects"]
    ) -> NDArray[np.float64]:
        new = [n for n in dict.fromkeys(names) if (target, kind, n) not in self._affinities]
        if new:
            prompt = affinity_prompt(target, new, kind)
            found = self._client.ask(prompt, partial(parse_affinities, prompt=prompt, names=new))
            for name, value in zip(new, found.tolist(), strict=True):
                self._affinities[target, kind, name] = value
        return np.array([self._affinities[target, kind, name] for name in names])


def _parse_room(text: str, prompt: Prompt) -> str:
    """R from the answer to the room's prompt."""
    rest = dict.fromkeys(ROOM_ONLY, 0)
    return room_name(parse_answer(text, prompt, Guidance, **rest).room_type)
