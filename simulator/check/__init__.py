"""Commands on measured sweeps: import, join, check and plot."""
