"""Reduced models of skins whose pixels are pressed by depth or force."""
