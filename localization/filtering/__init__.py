"""Touches over time: what sweep after sweep tells of a hand that comes, moves and goes."""
