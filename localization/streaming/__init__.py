"""Fresh sweeps for networks that train without a data set on disk."""
