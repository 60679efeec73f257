"""Every number of a scene file has a range, and beyond it a line that says so."""

import math

import pytest
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

EXTREMES = [math.nan, math.inf, -math.inf, -1e300, 1e300, 10**30, -(10**30), 1e30, 5e-324]
FOAM = {
    "thickness": 3e-3,
    "mechanics": {"porosity": 0.9, "solid_permittivity": 3.0, "modulus": 5e4, "tension": 10.0},
}
KEYS = {
    "skin.top.map": {"kind": "random", "deviation": 0.1, "correlation_length": 0.05},
    "skin.bottom.map": {"kind": "gradient", "x": 0.1, "y": 0.1},
    "skin.top.anisotropy": {"ratio": 2.0, "angle": 0.3},
    "skin.stretch": {"x": 1.1, "y": 1.0},
    "skin.shape": {"kind": "sphere", "radius": 0.2},
    "skin.foam": {**FOAM, "map": {"kind": "grid", "values": [[1.0, 1.1]]}},
    "press": {"depth": 5e-4},
    "dataset.press.depth": 5e-4,
    "design": {"seconds": 1.0, "band": [1e3, 1e5], "wires": 2, "want": 0.9},
}
"""What a scene may have beside what the built-in one has, so that all kinds of keys are there."""
WHOLE = load_scene("sheet-3x3").with_(KEYS)
OUTLINED = load_scene("sheet-3x3").with_(
    {
        "skin.outline": {"circle": [0.06, 0.06, 0.06], "holes": [{"circle": [0.06, 0.06, 0.01]}]},
        "contact.1.edge": "outline",
        "contact.2.edge": "outline",
    }
)


def numbers(table, place=""):
    """Where each number of a scene's table stands, as `Scene.with_` names it."""
    pairs = table.items() if isinstance(table, dict) else enumerate(table, 1)
    for key, value in pairs:
        if isinstance(value, dict | list | tuple):
            yield from numbers(value, f"{place}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{place}{key}"


def dumped(scene):
    return scene.model_dump(mode="json", by_alias=True, exclude_none=True)


EVERY = [(scene, key) for scene in (WHOLE, OUTLINED) for key in numbers(dumped(scene))]


@pytest.mark.parametrize(("scene", "key"), EVERY, ids=[key for _, key in EVERY])
def test_numbers_beyond_all_skins_are_refused_or_harmless(scene, key):
    for value in EXTREMES:
        try:
            changed = scene.with_({key: value})
        except InputError as refused:
            line = str(refused)
            assert "\n" not in line and "Error" not in line
            assert key.split(".")[0] in line or key.split(".")[-1] in line
        else:
            assert value == 5e-324, f"{key} = {value} is accepted"
            assert changed.skin.sides == scene.skin.sides
