"""Deflections on an even lattice: less exact than on triangles, for very many presses."""
