"""What `stability.py` is made of; its cases serve `verification.py`, too."""
