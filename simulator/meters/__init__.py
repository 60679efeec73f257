"""What makers state of their meters: accuracy tables, and the built-in readouts."""
