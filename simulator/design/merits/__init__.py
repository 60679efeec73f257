"""Merits of a design: information, separation, selection of readings, scores."""
