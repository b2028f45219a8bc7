"""Detectors behind one contract; importing this registers them all."""

from toponav.perception.base import (
    Detector,
    DetectorContext,
    check_detector,
    detectors,
    make_detector,
)
from toponav.perception.config import PerceptionConfig
from toponav.perception.noisy import NoisyDetector, NoisyDetectorConfig
from toponav.perception.onnx.detector import OnnxDetector
from toponav.perception.oracle import OracleDetector

__all__ = [
    "Detector",
    "DetectorContext",
    "NoisyDetector",
    "NoisyDetectorConfig",
    "OnnxDetector",
    "OracleDetector",
    "PerceptionConfig",
    "check_detector",
    "detectors",
    "make_detector",
]
