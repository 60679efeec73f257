"""Cosine modes over a skin: slow variation of its foam and of its sheets."""
