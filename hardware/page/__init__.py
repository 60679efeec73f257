"""Page served on the loopback: viewers receive the latest state and send presses."""
