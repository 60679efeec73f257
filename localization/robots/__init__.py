"""Examples of robots with skins in MuJoCo: localizers trained on simulation, and films."""
