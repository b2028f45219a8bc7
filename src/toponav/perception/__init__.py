"""Detectors behind one contract; importing this registers them all."""

from toponav.perception.base import (
    BatchDetector,
    Detector,
    DetectorContext,
    check_detector,
    detect_all,
    detectors,
    make_detector,
)
from toponav.perception.config import PerceptionConfig
from toponav.perception.glee.detector import GleeDetector
from toponav.perception.huggingface.detector import HuggingFaceDetector
from toponav.perception.noisy import NoisyDetector, NoisyDetectorConfig
from toponav.perception.onnx.detector import OnnxDetector
from toponav.perception.oracle import OracleDetector

__all__ = [
    "BatchDetector",
    "Detector",
    "DetectorContext",
    "GleeDetector",
    "HuggingFaceDetector",
    "NoisyDetector",
    "NoisyDetectorConfig",
    "OnnxDetector",
    "OracleDetector",
    "PerceptionConfig",
    "check_detector",
    "detect_all",
    "detectors",
    "make_detector",
]
