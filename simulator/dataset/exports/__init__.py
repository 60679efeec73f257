"""Sweeps in the formats of other programs: tables, and data sets of robot learning."""
