"""Data sets: many sweeps of randomised skins and presses, streamed to Zarr, resumable."""

from simulator.dataset.plan import Plan
from simulator.dataset.run import generate

__all__ = ["Plan", "generate"]
