"""Fits of a scene's physical parameters to measured sweeps, with their uncertainty."""
