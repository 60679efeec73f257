"""Files of a design search: the scene, tables, charts and a page."""
