"""What `answers.py` is made of."""
