"""One instrument: its connection, its conversation, its settings and its readings."""
