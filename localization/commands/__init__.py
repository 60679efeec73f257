"""The commands of the localizer."""
