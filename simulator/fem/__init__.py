"""Matrices: elements, circuits and systems, Galerkin and Lanczos, estimates of error."""
