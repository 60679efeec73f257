"""Contacts of a moment as cells and rises of c, by the law of the foam."""
