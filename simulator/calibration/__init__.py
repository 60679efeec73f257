"""Fitting a scene's physical parameters to measured sweeps, and how surely each is told."""

from .choice import Options
from .explained import Explained, gap_by_parameter
from .run import Calibration, calibrate

__all__ = ["Calibration", "Explained", "Options", "calibrate", "gap_by_parameter"]
