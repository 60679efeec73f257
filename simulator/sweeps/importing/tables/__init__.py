"""The table of a file: lines, header, columns, and how numbers are written."""
