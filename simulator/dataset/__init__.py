"""Data sets: many sweeps of randomised skins and presses, streamed to Zarr, resumable."""

from .plan import Plan
from .run import generate

__all__ = ["Plan", "generate"]
