"""Parameter studies: how well pixels are told apart while one or two numbers of a scene vary."""
