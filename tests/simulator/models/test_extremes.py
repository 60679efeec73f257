"""Scenes at the ends of what their keys may be: an answer within its tolerance, or one clear line.

The kinds of skins that are solved in milliseconds are drawn from; every kind is in the slow walk.
"""

import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.factors import factorised
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, every_press
from rcskin.simulator.scene.keys import at, keys
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.scene.validation import NumberRange, constraints_of
from rcskin.simulator.sweeps import InputError, ToleranceError
from scipy.sparse import csc_matrix

RTOL = 1e-3
FEW = {"sweep.frequencies": [1e3, 1e4, 1e5]}
FOAM = {
    "thickness": 3e-3,
    "mechanics": {"porosity": 0.9, "solid_permittivity": 3.0, "modulus": 5e4},
}
LEADS = {"resistance": 1.0, "inductance": 1e-6, "stray_capacitance": 1e-11, "guard": 0.5}
LOSSY = {"skin.foam.loss_tangent": 0.1, "skin.foam.phase_exponent": 0.9, "leads": LEADS}
FILMS = {"contact.1.resistance": 10.0, "contact.2.resistance": 10.0}
PRESSED = {"skin.foam": FOAM, "press": {"depth": 5e-4}}
ROUND = {
    "skin.outline": {"circle": [0.06, 0.06, 0.06], "holes": [{"circle": [0.06, 0.06, 0.01]}]},
    "contact.1.edge": "outline",
    "contact.2.edge": "outline",
}
GRID = {"kind": "grid", "values": [[1.0, 1.1], [1.0, 1.2]]}
SHEET = load_scene("sheet-3x3").with_(FEW)
QUICK = {"line": load_scene("strip-1x3").with_(FEW), "lossy": SHEET.with_({**LOSSY, **FILMS})}
EVERY = QUICK | {
    "depth": SHEET.with_(PRESSED),
    "tension": SHEET.with_(PRESSED).with_({"skin.foam.mechanics.tension": 10.0}),
    "force": SHEET.with_({**PRESSED, "press": {"force": 1.0}}),
    "piezoresistive": SHEET.with_({**PRESSED, "skin.top.piezoresistance": 1.0}),
    "anisotropic": SHEET.with_({"skin.top.anisotropy": {"ratio": 2.0, "angle": 0.3}, **FILMS}),
    "gradient": SHEET.with_({"skin.top.map": {"kind": "gradient", "x": 0.1, "y": 0.1}}),
    "grid": SHEET.with_({"skin.foam.map": GRID}),
    "sphere": SHEET.with_({"skin.shape": {"kind": "sphere", "radius": 0.2}}),
    "stretched": SHEET.with_({"skin.stretch": {"x": 1.1, "y": 1.0}}),
    "outline": SHEET.with_(ROUND),
}
ELSEWHERE = ("dataset.", "design.", "experiment.", "readout.", "pixels.")
"""What no answer depends on; and pixels, which are counted before any mesh."""
WITHIN = 1.001


def numbers(table, place=""):
    pairs = table.items() if isinstance(table, dict) else enumerate(table, 1)
    for key, value in pairs:
        if isinstance(value, dict | list):
            yield from numbers(value, f"{place}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{place}{key}"


def ends(key):
    """Both ends of what a key may be, and numbers slightly inside."""
    *parents, name = [part for part in key.split(".") if not part.isdigit()]
    fields = [keys(table).get(name) for table in at(Scene, tuple(parents))]
    annotations = [
        getattr(each, "func", each) for field in fields if field for each in constraints_of(field)
    ]
    found = {
        end
        for each in annotations
        if isinstance(each, NumberRange)
        for end in (each.low, each.high)
    }
    found |= {
        getattr(each, name)
        for each in annotations
        for name in ("ge", "gt", "le", "lt")
        if getattr(each, name, None) is not None
    }
    return sorted(found | {end * by for end in found for by in (WITHIN, 1 / WITHIN, 1e2, 1e-2)})


def extremes(scene):
    """(key, number) of a scene, all of them."""
    table = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    named = [key for key in numbers(table) if not key.startswith(ELSEWHERE)]
    return [(key, end) for key in named for end in ends(key)]


def hold(scene, changes, pressed):
    """Whether the changed scene is answered, within its tolerance; else it is refused in a line."""
    try:
        changed = scene.with_(changes)
        answer = Solver(changed.parts, RTOL).solve(
            every_press(changed.parts.skin, changed.press)[pressed]
        )
    except (InputError, ToleranceError) as refused:
        assert str(refused) and "\n" not in str(refused) and "nan" not in str(refused)
        return False
    assert np.isfinite(answer.Z).all()
    assert max(error.max() for error in answer.relative_errors) <= RTOL
    return True


@pytest.mark.parametrize("scene", QUICK.values(), ids=QUICK)
def test_each_key_at_its_ends_is_answered_or_refused_in_a_line(scene):
    drawn = random.Random(4).sample(extremes(scene), 20)
    kept = [hold(scene, {key: end}, pressed=k % 2) for k, (key, end) in enumerate(drawn)]
    assert any(kept) and not all(kept)


@given(st.data())
def test_keys_at_their_ends_together_are_answered_or_refused_in_a_line(data):
    scene = data.draw(st.sampled_from(list(QUICK.values())))
    changes = data.draw(st.lists(st.sampled_from(extremes(scene)), min_size=2, max_size=4))
    hold(scene, dict(changes), data.draw(st.integers(0, 1)))


@pytest.mark.parametrize("matrix", [np.zeros((3, 3)), np.full((3, 3), np.nan)], ids=["0", "nan"])
def test_singular_equations_are_refused_in_words_of_the_skin(matrix):
    with pytest.raises(ToleranceError, match="of the skin are singular in double precision"):
        factorised(csc_matrix(matrix))


@pytest.mark.parametrize("changes", [{"skin.width": 1e-5}, {"skin.length": 999.0}], ids=str)
def test_narrow_skins_that_vary_are_refused_before_they_are_meshed(changes):
    with pytest.raises(ToleranceError, match="a first mesh may have 15000"):
        Solver(EVERY["gradient"].with_(changes).parts, RTOL).solve(Press())


@pytest.mark.slow
@pytest.mark.parametrize("scene", EVERY.values(), ids=EVERY)
def test_every_key_of_every_kind_of_skin_at_its_ends(scene):
    kept = [
        hold(scene, {key: end}, pressed=1) for key, end in extremes(scene) if math.isfinite(end)
    ]
    assert any(kept)
