"""The meter: frequencies, leads, and errors by numbers, data sheet, spreads or a converter."""
