"""What a meter would show of a skin."""
