"""The reduced skin in PyTorch: batches of presses, with exact gradients."""
