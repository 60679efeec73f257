"""Parameter studies: accuracy while one or two numbers of a scene vary."""
