"""Maps of factors by position: constant, gradient, random field, grid, file or tear."""
