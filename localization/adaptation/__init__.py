"""A trained model taught by a few touches of the skin at hand, judged by others."""
