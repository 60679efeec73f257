"""Strips whose sheets and foam vary along them, against what a line does: chains and integrals."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene

LENGTH, WIDTH, TOP, BOTTOM, C = 0.1, 0.02, 50e3, 30e3, 5e-9
LOOP = (TOP + BOTTOM) * LENGTH / WIDTH
TOTAL = C * LENGTH * WIDTH
FREQUENCIES = (1e2, 1e4, 3e5)


@pytest.fixture
def strip(make_scene):
    """A strip of four pixels with further keys in its top, bottom and foam."""

    def strip(frequencies=FREQUENCIES, **tables):
        scene = make_scene(
            length=LENGTH,
            width=WIDTH,
            c=C,
            columns=4,
            top=TOP,
            bottom=BOTTOM,
            frequencies=frequencies,
        )
        given = scene.model_dump(by_alias=True, exclude_none=True)
        for name, table in tables.items():
            given["skin"][name] |= table
        return Scene.model_validate(given)

    return strip


def chained(segments, frequency):
    """Z of a line of segments (R, C) from the feed on, ohm and F, open at its end."""
    s = 2j * np.pi * frequency
    chain = np.broadcast_to(np.eye(2, dtype=complex), (len(s), 2, 2))
    for R, each in segments:
        q, Zc = np.sqrt(s * R * each), np.sqrt(R / (s * each))
        rows = [[np.cosh(q), Zc * np.sinh(q)], [np.sinh(q) / Zc, np.cosh(q)]]
        chain = chain @ np.moveaxis(np.array(rows), -1, 0)
    return chain[:, 0, 0] / chain[:, 1, 0]


@pytest.mark.parametrize("gauge", [(3.0, 3.0), (4.0, -0.5)])
def test_piezoresistive_sheets_are_a_chain_of_other_resistance_under_the_press(strip, gauge):
    """c times 2.5 is a strain of 0.6, so that each sheet's R is there 1 + 0.6 g times as large."""
    of_top, of_bottom = gauge
    scene = strip(top={"piezoresistance": of_top}, bottom={"piezoresistance": of_bottom})
    pressed = TOP * (1 + 0.6 * of_top) + BOTTOM * (1 + 0.6 * of_bottom)
    segments = [(LOOP / 4, TOTAL / 4)] * 4
    segments[1] = (LOOP / 4 * pressed / (TOP + BOTTOM), 2.5 * TOTAL / 4)
    Z = Solver(scene.parts, 1e-4).solve(Press((Touch(1, 2, 2.5),))).Z[0]
    np.testing.assert_allclose(Z, chained(segments, scene.frequencies), rtol=2e-4)


def test_sheets_that_differ_in_their_grain_add_up_along_it(strip):
    """Along the grain a sheet of conductance ratio k conducts sqrt(k) better than 1 / R."""
    scene = strip(
        top={"anisotropy": {"ratio": 4.0}},
        bottom={"anisotropy": {"ratio": 4.0, "angle": np.pi / 2}},
    )
    R = (TOP / 2 + BOTTOM * 2) * LENGTH / WIDTH
    Z = Solver(scene.parts, 1e-4).solve(Press()).Z[0]
    np.testing.assert_allclose(Z, chained([(R, TOTAL)], scene.frequencies), rtol=2e-4)


@pytest.mark.parametrize(("slope", "foam"), [(0.8, 0.0), (-1.2, 0.0), (0.5, 1.0), (0.0, -1.5)])
def test_low_frequency_resistance_is_the_integral_of_r_by_the_charge_beyond(strip, slope, foam):
    """Rs = integral of r (Q / Q_0)² and C = integral of c, with r of the top sheet and c straight.

    r = r_b + r_t (1 + slope (u - 1/2)), c = 1 + foam (u - 1/2), u = x / L.
    """
    tables = {"top": {"map": {"kind": "gradient", "x": slope}}}
    tables["foam"] = {"map": {"kind": "gradient", "x": foam}}
    scene = strip(frequencies=(1.0, 2.0), **tables)
    u = np.polynomial.Polynomial([0.0, 1.0])
    charge = (1 + foam * (u - 0.5)).integ()
    beyond = charge(1.0) - charge
    r = (BOTTOM + TOP * (1 + slope * (u - 0.5))) * LENGTH / WIDTH
    lost = (r * beyond**2).integ()
    Z = Solver(scene.parts, 1e-6).solve(Press()).Z[0]
    np.testing.assert_allclose(Z.real, lost(1.0), rtol=2e-6)
    Cp = (1 / Z).imag / (2 * np.pi * scene.frequencies)
    np.testing.assert_allclose(Cp, TOTAL, rtol=1e-6)


def test_a_grid_of_two_values_is_a_gradient(strip):
    values = [[0.6, 1.4]]
    one, other = (
        strip(top={"map": each})
        for each in ({"kind": "grid", "values": values}, {"kind": "gradient", "x": 0.8})
    )
    Z = [Solver(scene.parts, 1e-4).solve(Press()).Z for scene in (one, other)]
    np.testing.assert_allclose(*Z, rtol=2e-4)


def test_sheets_of_one_random_map_act_as_one_and_of_two_as_two(strip):
    """Both circuits agree where the second sheet differs by nothing to speak of."""
    drawn = {"kind": "random", "deviation": 0.4, "correlation_length": 0.03, "seed": 2}
    nearly = {**drawn, "deviation": 0.4 * (1 + 1e-13)}
    one = Solver(strip(top={"map": drawn}, bottom={"map": drawn}).parts, 1e-4).solve(Press())
    two = Solver(strip(top={"map": drawn}, bottom={"map": nearly}).parts, 1e-4).solve(Press())
    assert "one field" in one.model
    assert "two fields" in two.model
    np.testing.assert_allclose(two.Z, one.Z, rtol=2e-4)
