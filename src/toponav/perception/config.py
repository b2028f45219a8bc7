"""The parameters of every detector: the section `perception` of a run's configuration."""

from __future__ import annotations

from pydantic import Field

from toponav.config_model import ConfigModel
from toponav.perception.glee.detector import GleeConfig
from toponav.perception.huggingface.detector import HuggingFaceConfig
from toponav.perception.noisy import NoisyDetectorConfig
from toponav.perception.onnx.detector import OnnxConfig
from toponav.perception.oracle import OracleConfig


class PerceptionConfig(ConfigModel):
    """Each detector reads its own part."""

    oracle: OracleConfig = Field(default_factory=OracleConfig)
    """True labels."""

    noisy: NoisyDetectorConfig = Field(default_factory=NoisyDetectorConfig)
    """True labels with a real detector's errors."""

    onnx: OnnxConfig = Field(default_factory=OnnxConfig)
    """A model in an ONNX file."""

    huggingface: HuggingFaceConfig = Field(default_factory=HuggingFaceConfig)
    """An open-vocabulary model of the library transformers."""

    glee: GleeConfig = Field(default_factory=GleeConfig)
    """The paper's detector, from its authors' code."""


SURE = 0.5
"""From this score on the detections of DEIMv2-femto in furnished houses are right more often than
wrong (docs/perception.md)."""


def perception_preset(name: str) -> PerceptionConfig:
    """The detectors of a preset: `paper` takes what is detected for true, so it asks for more."""
    config = PerceptionConfig()
    if name != "paper":
        return config
    return config.model_copy(update={"onnx": config.onnx.model_copy(update={"threshold": SURE})})
