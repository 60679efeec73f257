"""What stands behind an answer: folds, calibrated probabilities, guards."""
