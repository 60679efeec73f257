"""Local refinement of meshes."""
