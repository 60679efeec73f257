"""What `calibration_coverage.py` is made of."""
