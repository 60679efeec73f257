"""Tables of other tools: how they are written, what their columns hold, where sweeps begin."""
