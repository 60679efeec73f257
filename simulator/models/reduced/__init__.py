"""Certified reduced models of a scene's family of skins and presses."""
