"""What `twin.py` and `twin_limits.py` are made of."""
