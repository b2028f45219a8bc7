"""Detectors behind one contract; importing this registers them all."""

from toponav.perception.base import Detector, DetectorContext, detectors
from toponav.perception.config import PerceptionConfig
from toponav.perception.noisy import NoisyDetector, NoisyDetectorConfig
from toponav.perception.oracle import OracleDetector

__all__ = [
    "Detector",
    "DetectorContext",
    "NoisyDetector",
    "NoisyDetectorConfig",
    "OracleDetector",
    "PerceptionConfig",
    "detectors",
]
