"""Virtual meter: speaks the IM3523's language over TCP, and reads a given skin."""
