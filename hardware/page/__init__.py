"""A page served on the loopback: viewers get the latest state, their presses come back."""
