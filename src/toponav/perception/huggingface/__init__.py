"""Open-vocabulary detectors and mask refinement through the library `transformers`."""
