"""Matrices of elements: quadrature, assembly in a fixed pattern, and factors."""
