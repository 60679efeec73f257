"""What answers for a skin; `solver` picks the cheapest that keeps the tolerance."""
