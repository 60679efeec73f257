"""Touches on the skin, and the capacitance they make."""
