"""Gap between simulation and measurement: distances, accuracies, causes, and a report."""
