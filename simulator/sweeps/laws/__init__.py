"""Laws that every sweep of a passive skin obeys, tests for them, and the noise of readings."""
