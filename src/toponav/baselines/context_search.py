"""What the frontier methods share that know what goes with the target."""

from __future__ import annotations

from toponav.baselines.frontier_search import FrontierSearch
from toponav.baselines.relevance import Relevance
from toponav.config import NavigatorConfig
from toponav.perception.base import Detector
from toponav.policy.decision import DecisionListener
from toponav.reasoning.base import Reasoner


class ContextSearch(FrontierSearch):
    """Looks for everything that the detector may find, and asks the reasoner what it tells."""

    def __init__(
        self,
        detector: Detector,
        reasoner: Reasoner,
        config: NavigatorConfig,
        listener: DecisionListener,
    ) -> None:
        """Take the shared parts; the reasoner gives the affinities."""
        self._reasoner = reasoner
        super().__init__(detector, config, listener)

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        super().reset(goal)
        self._relevance = Relevance(self._reasoner, self._target)

    def _wanted_categories(self) -> tuple[str, ...]:
        return self._full_vocabulary()
