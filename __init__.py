"""Simulator of a capacitive soft sensor skin, its localizer, and the driver of its meter."""
