"""Touches of a given size rasterized on the cells of a grid, by factors or by depth."""
