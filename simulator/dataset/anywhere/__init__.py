"""Touches of a data set that are no whole pixels: random places, and rasterization on cells."""
