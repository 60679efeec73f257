"""The skin, its wiring and its readings that tell most within what a designer must keep."""
