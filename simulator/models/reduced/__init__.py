"""A scene's family of skins and presses in a small basis, certified."""
