"""Impedances and gains from the columns of a table, and their agreement."""
