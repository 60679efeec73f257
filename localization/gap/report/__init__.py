"""Report of the gap between simulation and measurement."""
