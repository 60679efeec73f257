"""Deflections on a uniform lattice: less exact than on triangles, for very many presses."""
