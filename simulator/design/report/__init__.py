"""What a search leaves: the scene, tables, charts and a page."""
