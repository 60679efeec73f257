"""Touches of a size on the cells of a grid: what they do to c there, by factors or by depth."""
