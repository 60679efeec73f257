"""Bounds on the information in readings, for limits and for scores of designs."""
