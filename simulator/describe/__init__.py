"""Describes a scene in words and as a drawing."""
