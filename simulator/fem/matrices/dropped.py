"""Index of a pair or an unknown that is left out of a matrix."""

DROPPED = -1
