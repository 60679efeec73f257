"""The physics: from a scene to what a meter would read."""
