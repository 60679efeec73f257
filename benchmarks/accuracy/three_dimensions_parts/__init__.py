"""Three-dimensional reference: static solve of foam and air, and skins made of it."""
