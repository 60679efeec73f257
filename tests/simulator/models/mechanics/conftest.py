"""Skins of foam with known mechanics."""

import pytest

THICKNESS, MODULUS = 4e-3, 30e3


@pytest.fixture
def foam_scene(make_scene):
    """A function that makes a skin of 120 x 40 mm on foam, with a tension and other mechanics."""

    def made(tension=50.0, stress_strain="linear", press=None, **skin):
        mechanics = {
            "porosity": 0.67,
            "solid_permittivity": 2.79,
            "modulus": MODULUS,
            "stress_strain": stress_strain,
            "tension": tension,
        }
        scene = make_scene(length=0.12, width=0.04, rows=1, columns=3)
        given = scene.model_dump(by_alias=True, exclude_none=True)
        given["skin"]["foam"] = {"thickness": THICKNESS, "mechanics": mechanics}
        given["skin"].update(skin)
        given["press"] = press or {}
        return type(scene).model_validate(given)

    return made
