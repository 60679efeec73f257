"""Trained localizers as files that run without Python: ONNX graphs, and C code."""
