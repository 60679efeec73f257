"""How far simulation is from what it stands for: distances, accuracies, causes, in one report."""
