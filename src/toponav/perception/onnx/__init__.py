"""Object detectors in ONNX files: `--detector onnx:MODEL.onnx` (extra `onnx`)."""
