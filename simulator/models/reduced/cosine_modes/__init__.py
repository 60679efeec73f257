"""Cosine modes of the foam within its parts: terms of M, as those of sheets are terms of K."""
