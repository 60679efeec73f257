"""Heterogeneous skins of any outline: elements with coefficients by quadrature."""
