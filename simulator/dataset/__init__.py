"""Data sets: many sweeps of randomised skins and presses, streamed to Zarr, resumable."""
