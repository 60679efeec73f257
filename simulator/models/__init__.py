"""Models of a skin; `solver` chooses the cheapest one that keeps the tolerance."""
