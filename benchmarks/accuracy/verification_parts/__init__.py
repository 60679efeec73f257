"""The parts of the verification: each measures, and states what it expects beside it."""
