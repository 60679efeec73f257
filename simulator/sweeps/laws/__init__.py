"""Laws that every sweep of a skin keeps, whether one does, and the noise of its readings."""
