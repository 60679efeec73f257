"""Switches that connect the meter to one interface of a skin at a time."""
