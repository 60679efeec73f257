"""Terminals of a skin: circuit, excitations, and the network between terminals."""
