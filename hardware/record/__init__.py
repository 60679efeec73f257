"""Recording of a skin: presses in a given order, each measured, checked and saved."""
