"""Adaptation of a trained model to the actual skin by a few touches."""
