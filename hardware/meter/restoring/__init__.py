"""Restoring of a meter's settings: originals, snapshots, and an orderly end on a signal."""
