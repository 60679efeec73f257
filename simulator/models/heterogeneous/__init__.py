"""Skins whose sheets and foam vary from place to place, of any outline: elements by quadrature."""
