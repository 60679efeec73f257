"""The virtual reader: sends lines of a simulated skin, as a microcontroller does."""
