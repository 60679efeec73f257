"""A reader that excites all frequencies at once: its settings, its excitation and its noise."""
