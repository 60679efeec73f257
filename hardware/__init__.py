"""LCR meter, recorder, live localization and a virtual meter. All yield the simulator's sweeps."""
