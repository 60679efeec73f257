"""A trained localizer, and its file."""
