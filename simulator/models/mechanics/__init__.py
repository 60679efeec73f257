"""Mechanics of a press: strain of the foam by depth or force."""
