"""Intervals that follow the likelihood where it bends, or where a bound cuts."""
