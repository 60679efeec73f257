"""Recording a skin: an order of presses, each measured, checked and kept."""
