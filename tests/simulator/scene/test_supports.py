"""The table of what goes with what: each refusal in one line, and each feature by its key."""

import pytest
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.scene.supports import FEATURES, USES, supported
from rcskin.tests.refusals import refusal_of

BODY = {"side": "bottom", "distance": 5e-3}
CREEP = {"skin.foam.relaxation": [{"share": 0.2, "time_constant": 1.0}]}
MAP = {"kind": "gradient", "x": 0.1}
COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}
FINGER = {"surroundings": {"low": "virtual earth", "cover": COVER}}
SCENES = {
    "around": ("sheet-3x3", {"surroundings": {"body": [BODY]}}),
    "walls": ("sheet-3x3", {"surroundings": {"thickness": True, "edges": True}}),
    "thickness": ("sheet-3x3", {"surroundings.thickness": True}),
    "solved": ("sheet-3x3", {"surroundings.solved": True}),
    "heterogeneous": ("sheet-3x3", {"skin.top.anisotropy": {"ratio": 2.0}}),
    "foam map": ("sheet-3x3", {"skin.foam.map": MAP}),
    "sheet map": ("sheet-3x3", {"skin.bottom.map": MAP}),
    "gauge": ("sheet-3x3", {"skin.top.piezoresistance": 2.0}),
    "one conductor": ("knit-36", {}),
    "leak": ("sheet-3x3", {"skin.foam.leak": 1e-9}),
    "creep": ("foam", CREEP),
    "creep by depth": ("foam", CREEP),
    "law": ("foam", {"skin.top.piezoresistance": 2.0}),
    "depth": ("foam", {}),
    "spread": ("foam", {}),
    "finger": ("sheet-3x3", {**FINGER, "press.finger": 5e-12}),
    "drawn finger": ("sheet-3x3", {**FINGER, "dataset.press.finger": 5e-12}),
    "adds": ("knit-36", {}),
    "together": ("knit-36", {}),
    "gains": ("knit-36", {}),
    "drawn body": (
        "sheet-3x3",
        {"surroundings": {"solved": True, "body": [BODY]}, "dataset.session.body": 2.0},
    ),
    "own frequencies": ("sheet-5x5-two-interfaces", {"interface.1.frequencies": [1e3]}),
    "faults": ("sheet-3x3", {"dataset.session.faults": {}}),
}


@pytest.mark.parametrize("use", USES)
def test_a_use_refuses_a_feature_by_its_key_and_the_reason(use):
    for feature in USES[use].keys() & SCENES.keys():
        name, changes = SCENES[feature]
        parts = load_scene(name).with_(changes).parts
        (key, *_) = FEATURES[feature][1](parts.skin, parts.setup, parts.plan)
        line = refusal_of(supported, use, parts)
        assert line.startswith(f"{name}: {use} cannot take `") and line.split("`: ")[1], feature


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("scene", ["sheet-3x3", "strip-1x5"])
def test_a_plain_scene_goes_with_every_use(use, scene):
    parts = load_scene(scene).parts
    assert supported(use, parts) is parts
