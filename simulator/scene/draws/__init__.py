"""Random draws of a data set: distributions, variation of skins and presses, odds of faults."""
