"""Outlines, shapes in space and meshes of skins."""
