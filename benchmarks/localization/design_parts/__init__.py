"""What `twin_design.py` and its siblings are made of."""
