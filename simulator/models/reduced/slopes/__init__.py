"""How the admittance of a reduced skin changes with it: of one press, and of many at once."""
