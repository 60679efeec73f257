"""Driver of one meter: connection, conversation, settings and readings."""
