"""What goes from one search to the next in the same building."""

from __future__ import annotations

from dataclasses import dataclass

from toponav.errors import InputError
from toponav.knowledge import Knowledge, RecallingAgent
from toponav.types import Agent


@dataclass
class Recollection:
    """Holds what is known between agents.

    Attributes:
        knowledge: None before the first search.
    """

    knowledge: Knowledge | None = None

    def give_to(self, agent: Agent) -> None:
        """Let an agent start its next episode with it.

        Raises:
            InputError: It is one that cannot.
        """
        recalling = _recalling(agent)
        if self.knowledge is not None:
            recalling.recall(self.knowledge)

    def take_from(self, agent: Agent) -> None:
        """Keep what an agent has learnt."""
        self.knowledge = _recalling(agent).knowledge


def _recalling(agent: Agent) -> RecallingAgent:
    if not isinstance(agent, RecallingAgent):
        name = type(agent).__name__
        raise InputError(f"{name} forgets the building after every search: use --method toponav")
    return agent
