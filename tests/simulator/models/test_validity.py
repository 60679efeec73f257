"""Where the foam is too thick for the thin-sheet model, it is said."""

import numpy as np
import pytest
from rcskin.simulator.models.validity import lateral_error, warnings
from rcskin.simulator.scene.files import builtin_names, load_scene
from rcskin.simulator.scene.scene import Scene


def with_foam(make_scene, **foam):
    """A scene whose foam is given by its geometry."""
    scene = make_scene(**foam.pop("scene", {})).model_dump(by_alias=True)
    scene["skin"]["foam"] = foam
    return Scene.model_validate(scene)


@pytest.mark.parametrize("name", builtin_names())
def test_the_papers_devices_are_within_the_model(name):
    assert warnings(load_scene(name)) == []


def test_the_lateral_error_is_the_first_term_of_laplaces_equation():
    """Potentials that vary along the sheets charge them (k d / 2) coth(k d / 2) times as much."""
    d, depth = 1e-3, 20e-3
    half = np.sqrt(2j) / depth * d / 2
    assert lateral_error(d, depth) == pytest.approx(abs(half / np.tanh(half) - 1), rel=1e-3)


@pytest.mark.parametrize(
    ("scene", "told"),
    [
        ({"frequencies": [1e3, 1e7]}, "currents along the foam change Rs and Cp"),
        ({"length": 0.02}, "fields around the edges add"),
        ({"columns": 20}, "pixels of 5 mm are less than 2 times"),
    ],
)
def test_each_limit_is_told(make_scene, scene, told):
    scene = with_foam(make_scene, thickness=4e-3, relative_permittivity=2.2, scene=scene)
    (warning,) = warnings(scene)
    assert told in warning


def test_a_capacitance_alone_tells_how_thin_the_foam_can_be(make_scene):
    """In vacuum: 1.8 mm at 5 nF/m²; any permittivity makes it thicker."""
    assert warnings(make_scene(frequencies=[1e5])) == []
    (warning,) = warnings(make_scene(frequencies=[1e7]))
    assert "the foam's 1.8 mm" in warning
