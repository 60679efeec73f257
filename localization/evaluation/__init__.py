"""How often answers are right, by sweeps that shaped nothing."""
