"""Rectangles pressed anywhere on plain skins fed along whole edges, in products of cosines."""
