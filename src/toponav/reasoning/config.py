"""The parameters of every reasoner: the section `reasoning` of a run's configuration."""

from __future__ import annotations

from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.reasoning.noisy import NoisyReasonerConfig
from toponav.reasoning.prior import PriorConfig
from toponav.reasoning.vlm.config import VlmConfig


class ReasoningConfig(ConfigModel):
    """Each reasoner reads its own part."""

    prior: PriorConfig = Field(default_factory=PriorConfig)
    """Common knowledge, offline."""

    noisy: NoisyReasonerConfig = Field(default_factory=NoisyReasonerConfig)
    """The prior with a model's errors of sight."""

    openai: VlmConfig = Field(default_factory=VlmConfig)
    """A model behind any OpenAI-compatible server."""


def reasoning_preset(name: str) -> ReasoningConfig:
    """The reasoners of a preset: `paper` asks for the room's type in a call of its own."""
    config = ReasoningConfig()
    prompt = config.openai.prompt.model_copy(update={"two_calls": name == "paper"})
    openai = config.openai.model_copy(update={"prompt": prompt})
    return config.model_copy(update={"openai": openai})
