"""Parts of `several_touches.py`."""
