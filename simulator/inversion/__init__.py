"""Tables for localizers that invert the simulator: touches, positions and unknown skins."""
