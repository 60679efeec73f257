"""The commands that the virtual meter knows."""
