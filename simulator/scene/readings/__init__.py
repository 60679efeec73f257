"""Readings: foils, interfaces and readers, and the impedances from which gains follow."""
