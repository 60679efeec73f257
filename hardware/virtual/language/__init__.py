"""Command language of the virtual meter."""
