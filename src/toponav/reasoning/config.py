"""The parameters of every reasoner: the section `reasoning` of a run's configuration."""

from __future__ import annotations

from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.reasoning.noisy import NoisyReasonerConfig
from toponav.reasoning.prior import PriorConfig


class ReasoningConfig(ConfigModel):
    """Each reasoner reads its own part."""

    prior: PriorConfig = Field(default_factory=PriorConfig)
    """Common knowledge, offline."""

    noisy: NoisyReasonerConfig = Field(default_factory=NoisyReasonerConfig)
    """The prior with a model's errors of sight."""
