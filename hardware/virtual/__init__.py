"""Virtual meters: each speaks the language of a real model over TCP, and reads a given skin."""
