"""The keys of scene files, derived from the models that validate them."""
