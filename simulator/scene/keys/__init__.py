"""The keys that a scene file may have, read off the models that check it."""
