"""Fitting a scene's physical parameters to measured sweeps, and how surely each is told."""

from simulator.calibration.explained import Explained, gap_by_parameter
from simulator.calibration.run import Calibration, Options, calibrate

__all__ = ["Calibration", "Explained", "Options", "calibrate", "gap_by_parameter"]
