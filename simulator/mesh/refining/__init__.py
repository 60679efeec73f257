"""Meshes made finer where that is asked for."""
