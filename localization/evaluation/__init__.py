"""Accuracy of localizers on sweeps that were not used for training."""
