"""Laws that every sweep of a skin keeps, and whether one does: the noise of readings beside them."""
