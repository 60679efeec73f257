"""Fitting a scene's physical parameters to measured sweeps, and how surely each is told."""
