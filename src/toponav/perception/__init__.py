"""Detectors behind one contract; importing this registers them all."""

from toponav.perception.base import Detector, detectors
from toponav.perception.oracle import OracleDetector

__all__ = ["Detector", "OracleDetector", "detectors"]
