"""Fitting a scene's physical parameters to measured sweeps, and how surely they are told."""

from simulator.calibration.calibrate import Calibration, Options, calibrate
from simulator.calibration.explained import Explained, gap_by_parameter

__all__ = ["Calibration", "Explained", "Options", "calibrate", "gap_by_parameter"]
