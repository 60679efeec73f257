"""Small dense systems of reduced skins: Lanczos' method and Woodbury's formula, compiled."""
