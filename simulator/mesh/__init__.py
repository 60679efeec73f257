"""Meshes of a scene and a press: quadrilaterals or triangles."""
