"""What `foreign_twin.py` is made of."""
