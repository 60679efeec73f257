"""Tracking of touches over time: answers that use all sweeps so far."""
