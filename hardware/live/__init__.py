"""Touches told as they come."""
