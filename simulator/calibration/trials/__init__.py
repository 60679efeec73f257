"""Trial fits of physics and surroundings that a scene lacks."""
