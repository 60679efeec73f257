"""Skins of the paper's two sizes with the thickness of their foam."""

import pytest
from rcskin.simulator.scene.scene_files import load_scene


def _skin(name, **surroundings):
    return load_scene(name).with_(
        {"skin.foam.thickness": 4e-3, "surroundings": {"rim": True, **surroundings}}
    )


@pytest.fixture(scope="session")
def skin():
    """A function of a scene's name and of what surrounds it."""
    return _skin
