"""What `reduction.py` is made of."""
