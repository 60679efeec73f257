"""What stands for a pair or an unknown that is left out."""

DROPPED = -1
