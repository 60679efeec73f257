"""What readings can tell at most: what limits are made of, and designs are judged by."""
