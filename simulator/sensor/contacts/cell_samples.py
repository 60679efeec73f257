"""Density of the samples in cells that the skin's edge passes, or where patches overlap."""

SAMPLES = 16
"""Samples along each side of a cell."""
