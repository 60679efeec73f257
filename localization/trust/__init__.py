"""Calibration of answers: folds, probabilities, guards against novel sweeps."""
