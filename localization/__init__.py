"""Localization: which part of the skin was pressed, with the uncertainty of each answer."""
