"""Virtual instruments of Keysight: LCR meters E4980A, E4980AL and 4284A, analyser E4990A."""
