"""Sweeps from few real solves by Lanczos' method."""
