"""Parts of the benchmark of knitted touch pads."""
