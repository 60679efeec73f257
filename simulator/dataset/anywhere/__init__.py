"""Touches of a data set that are no whole pixels: where they are drawn, and on which cells."""
