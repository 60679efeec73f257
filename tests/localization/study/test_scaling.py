"""The law of scale tells exactly which impedances follow from one another."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.localization.study.sharing import Scaling, Skin
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.measure.symmetry import representative
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.sheet import Sheet
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.meter import Leads

FREQUENCY = np.geomspace(1e2, 1e6, 3)
PAIR = {"top-left": {}, "bottom-left": {}}


def impedance(scene, press, frequency):
    """Z in ohm by elements that are the same for all scenes of a shape."""
    return Sheet(scene, two_fields(scene), Resolution(order=3)).impedance(press, frequency)


def scaled(scene, resistance, capacitance):
    """The scene with all resistances and the foam's capacitance multiplied."""
    table = scene.model_dump(by_alias=True, exclude_none=True)
    for sheet in ("top", "bottom"):
        table["skin"][sheet]["sheet_resistance"] *= resistance
    for contact in table["contact"]:
        contact["resistance"] *= resistance
    table["skin"]["foam"]["capacitance_per_area"] *= capacitance
    return type(scene).model_validate(table)


@given(data=st.data())
def test_what_follows_by_the_law_is_what_a_solve_of_its_own_gives(random, data):
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    resistance, capacitance = (data.draw(random.logarithmic(1e-3, 1e3)) for _ in range(2))
    other = scaled(scene, resistance, capacitance)
    law = Skin(other).follows_from(Skin(scene))
    assert law is not None
    assert law.impedance == pytest.approx(resistance, rel=1e-9)
    assert law.frequency == pytest.approx(resistance * capacitance, rel=1e-9)
    followed = law.impedance * impedance(scene, press, law.frequency * FREQUENCY)
    np.testing.assert_allclose(impedance(other, press, FREQUENCY), followed, rtol=1e-9)


def test_of_a_line_only_the_sum_of_the_sheets_counts(make_scene):
    scene = make_scene(PAIR, top=50e3, bottom=30e3, columns=3, rows=2)
    other = make_scene(PAIR, top=10e3, bottom=30e3, columns=3, rows=2)
    law = Skin(other).follows_from(Skin(scene))
    assert law == Scaling(pytest.approx(0.5), pytest.approx(0.5))
    press = Press((Touch(1, 2, 2.0),))
    followed = 0.5 * impedance(scene, press, 0.5 * FREQUENCY)
    np.testing.assert_allclose(impedance(other, press, FREQUENCY), followed, rtol=1e-9)


@pytest.mark.parametrize(
    "changed",
    [
        {"loss_tangent": 0.01},
        {"columns": 4},
        {"length": 0.11},
        {"contacts": {"top-left": {}, "bottom-left": {"resistance": 1.0}}},
        {"contacts": {"top-left": {}, "bottom-left": {"span": [0.0, 0.5]}}},
    ],
)
def test_another_shape_does_not_follow(make_scene, changed):
    assert Skin(make_scene(**changed)).follows_from(Skin(make_scene())) is None


@pytest.mark.parametrize("exponent", [1.0, 0.8])
def test_a_constant_phase_foam_scales_with_its_exponent(make_scene, exponent):
    scene, other = (
        _changed(make_scene(PAIR, **more, rows=2, columns=2), phase_exponent=exponent)
        for more in ({}, {"top": 100e3, "bottom": 60e3, "c": 8e-9})
    )
    law, press = Skin(other).follows_from(Skin(scene)), Press((Touch(1, 2, 2.0),))
    assert law is not None
    followed = law.impedance * impedance(scene, press, law.frequency * FREQUENCY)
    np.testing.assert_allclose(impedance(other, press, FREQUENCY), followed, rtol=1e-9)


def test_behind_leads_nothing_scales(make_scene):
    leads = Leads(resistance=10.0)
    scene, other = (make_scene(PAIR, c=c).model_copy(update={"leads": leads}) for c in (5e-9, 6e-9))
    assert Skin(scene).follows_from(Skin(other)) is None
    assert Skin(scene).follows_from(Skin(scene)) == Scaling(1.0, 1.0)


def _changed(scene, **foam):
    skin = scene.skin.model_copy(update={"foam": scene.skin.foam.model_copy(update=foam)})
    return scene.model_copy(update={"skin": skin})


def test_one_sheet_of_a_crossed_skin_does_not_scale_alone(make_scene):
    crossed = {"top-left": {}, "bottom-bottom": {}}
    assert Skin(make_scene(crossed, top=1e3)).follows_from(Skin(make_scene(crossed))) is None


def test_meter_presses_and_frequencies_are_no_part_of_the_skin(make_scene):
    scene = make_scene()
    assert Skin(make_scene(factor=3.0, frequencies=(5e3,))).follows_from(Skin(scene)) == Scaling(
        1.0, 1.0
    )


MERGED = {
    "sheet-5x5": [(4, 2), (4, 5)],
    "sheet-5x5-crossed": [(4, 2)],  # along the diagonal, with the sheets exchanged
    "sheet-5x5-two-interfaces": [],
}


@pytest.mark.parametrize("name", MERGED)
def test_mirrored_pixels_show_the_same(name):
    scene = load_scene(name)
    of = representative(scene)
    solver = Solver(scene, rtol=1e-6)
    merged = [(i, j) for i in (1, 4) for j in (2, 5) if of((i, j)) != (i, j)]
    assert merged == MERGED[name]
    for pixel in merged:
        own, other = (solver.solve(Press((Touch(*at, 2.0),))).Z for at in (pixel, of(pixel)))
        np.testing.assert_allclose(own, other, rtol=1e-5)


def test_a_skin_fed_all_around_has_two_mirrors(make_scene):
    edges = ("left", "right", "bottom", "top")
    contacts = {f"{sheet}-{edge}": {} for sheet in ("top", "bottom") for edge in edges}
    interfaces = {
        "meter": [[name for name in contacts if name.startswith(s)] for s in ("top", "b")]
    }
    of = representative(make_scene(contacts, interfaces, rows=4, columns=3))
    assert {of((i, j)) for i in range(1, 5) for j in range(1, 4)} == {
        (1, 1),
        (1, 2),
        (2, 1),
        (2, 2),
    }
