"""The gap between simulation and measurement, told and drawn."""
