"""The meter that reads a real skin; its readings enter as the same sweeps as simulated ones."""
