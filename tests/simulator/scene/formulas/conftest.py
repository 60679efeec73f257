"""Random arguments, and skins of foam with mechanics."""

import numpy as np
import pytest
from rcskin.simulator.scene.scene import Scene


@pytest.fixture(params=range(3))
def rng(request):
    """Random arguments, three times over."""
    return np.random.default_rng(request.param)


@pytest.fixture
def on_foam(make_scene):
    """A function that makes a skin of 120 x 40 mm on 4 mm of foam; keywords: of its mechanics."""

    def on_foam(foam=None, press=None, **mechanics):
        made_of = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}
        given = make_scene(length=0.12, width=0.04, columns=3).model_dump(
            by_alias=True, exclude_none=True
        )
        given["skin"]["foam"] = {
            "thickness": 4e-3,
            "mechanics": {**made_of, **mechanics},
            **(foam or {}),
        }
        given["press"] = press or {}
        return Scene.model_validate(given)

    return on_foam
