"""Conversion of sweeps to features and targets."""
