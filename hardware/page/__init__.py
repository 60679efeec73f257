"""A page served on the loopback: the newest of what is shown to its viewers, their presses back."""
