"""Sweeps as files of each kind."""
