"""Leads and constant-phase foam: closed forms of the line behind them, and tolerances kept."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.parameters import leads_of, own_values, parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.meter import Leads

LEADS = Leads(resistance=300.0, inductance=2e-3, stray_capacitance=6e-12)
FREQUENCIES = (1e2, 1e3, 1e4, 1e5)


def behind(scene, leads=LEADS, **foam):
    skin = scene.skin.model_copy(update={"foam": scene.skin.foam.model_copy(update=foam)})
    return scene.model_copy(update={"leads": leads, "skin": skin})


@pytest.mark.parametrize("exponent", [0.6, 0.9, 1.0])
def test_the_coth_law_of_a_constant_phase_line_behind_leads(make_scene, exponent):
    scene = behind(make_scene(frequencies=FREQUENCIES), phase_exponent=exponent)
    f, skin = scene.frequencies, scene.skin
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    charging = 2e3j * np.pi * C * (1j * f / 1e3) ** exponent / 1j
    q = np.sqrt(R * charging)
    line = R / np.tanh(q) / q
    omega = 2j * np.pi * f
    stray = 1 / (1 / line + omega * LEADS.stray_capacitance)
    expected = LEADS.resistance + omega * LEADS.inductance + stray
    np.testing.assert_allclose(Solver(scene.parts).solve(Press()).Z[0], expected, rtol=1e-10)


@pytest.mark.parametrize("exponent", [0.8, 1.0])
@pytest.mark.parametrize("rtol", [1e-3, pytest.param(1e-5, marks=pytest.mark.slow)])
def test_the_tolerance_is_kept_behind_leads(make_scene, exponent, rtol):
    crossed = make_scene({"top-left": {}, "bottom-bottom": {}}, rows=2, columns=2, c=2e-8)
    scene = behind(crossed, phase_exponent=exponent)
    press = parse_press("1,2", 2.0)
    answer, truth = (Solver(scene.parts, each).solve(press) for each in (rtol, 1e-8))
    off = relative_difference(answer.Z, truth.Z).reshape(2, -1)
    told = np.stack(answer.relative_errors).reshape(2, -1)
    assert (off <= told).all()
    assert (told <= rtol).all()


def test_ideal_leads_change_no_bit(make_scene):
    scene = make_scene(rows=1, columns=2)
    press = parse_press("1,2", 2.0)
    plain, led = Solver(scene.parts).solve(press), Solver(behind(scene, Leads()).parts).solve(press)
    np.testing.assert_array_equal(plain.Z, led.Z)
    np.testing.assert_array_equal(plain.Rs_error, led.Rs_error)


@pytest.mark.parametrize("guard", [0.0, 0.4, 1.0])
def test_a_guard_keeps_its_part_of_the_stray_capacitance_from_the_meter(make_scene, guard):
    """Wherever leads enter: solved as they stand, and as parameters of a reduced model."""
    scene = make_scene(rows=1, columns=2, frequencies=FREQUENCIES)
    guarded = behind(scene, LEADS.model_copy(update={"guard": guard}))
    left = LEADS.model_copy(update={"stray_capacitance": (1 - guard) * LEADS.stray_capacitance})
    press = parse_press("1,2", 2.0)
    one, other = (Solver(each.parts).solve(press) for each in (guarded, behind(scene, left)))
    np.testing.assert_allclose(one.Z, other.Z, rtol=1e-14)
    np.testing.assert_allclose(one.Cp_error, other.Cp_error, rtol=1e-9)
    assert leads_of(own_values(guarded.parts.skin, guarded.parts.setup)).unguarded == pytest.approx(
        left.stray_capacitance
    )
    assert parts_with(guarded.parts, {}).setup.leads.unguarded == pytest.approx(
        left.stray_capacitance
    )


def test_a_perfect_guard_alone_leaves_ideal_leads():
    assert Leads(stray_capacitance=1e-12, guard=1.0).ideal
    assert not Leads(stray_capacitance=1e-12, guard=0.9).ideal
