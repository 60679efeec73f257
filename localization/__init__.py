"""From sweeps to touches: which pixel was pressed, and how sure that answer is."""
