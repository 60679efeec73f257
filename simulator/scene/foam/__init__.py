"""The foam: capacitance and losses, mechanics, and changes with time, temperature and humidity."""
