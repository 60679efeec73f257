"""Design search: the best skin, wiring and readings within a designer's constraints."""
