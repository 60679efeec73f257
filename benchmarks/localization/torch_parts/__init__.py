"""Networks, a design and rates of `torch_training.py`."""
