"""Estimators that learn touches from sweeps."""
