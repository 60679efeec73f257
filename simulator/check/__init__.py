"""Measured sweeps: brought in from other tools, and checked."""
