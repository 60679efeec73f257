"""From sweeps to features and targets."""
