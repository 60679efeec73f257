"""Slow unevenness of a skin: half waves over it, of its foam and of its sheets."""
