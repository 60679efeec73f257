"""Full models of a family of skins with affine matrices, on quadrilaterals or triangles."""
