"""Touches told by the simulator's own curves."""
