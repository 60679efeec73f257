"""A scene and a press as quadrilaterals or triangles."""
