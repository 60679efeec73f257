"""Measurements that a meter would take of a skin."""
