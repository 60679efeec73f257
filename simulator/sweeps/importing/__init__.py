"""Import of other tools' tables: dialect, meaning of columns, grouping of lines into sweeps."""
