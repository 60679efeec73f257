"""Scenes: skin, contacts, shape and meter; reading and checking of scene files."""
