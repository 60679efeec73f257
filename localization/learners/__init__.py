"""Estimators of touches."""
