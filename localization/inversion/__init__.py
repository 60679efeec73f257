"""Localizers that invert the simulator."""
