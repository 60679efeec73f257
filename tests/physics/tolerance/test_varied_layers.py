"""Far above cut-off the field has a layer wherever what a sheet carries jumps: the error told."""

import numpy as np
import pytest
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.frequency import laplace_variable

LENGTH, C, SHEET = 0.12, 5e-9, 2e4
BY_CHANCE = [
    # gauges of top and bottom, film, width in m, pixels, press, omega (R_t + R_b) c L², asked
    ((0.0, 2.1), 0.0, 0.02, (3, 5), "3,2:3.6", 1.57e4, 6e-4),
    pytest.param((2.5, 0.0), 30.0, 0.06, (2, 5), "2,3:2.6", 5e3, 1e-4, marks=pytest.mark.slow),
]


@pytest.fixture
def opposite(varied):
    """A rectangle fed from opposite ends, its sheets gauges."""

    def opposite(gauges, film, width, pixels, **keywords):
        return varied(
            {f"{s}.piezoresistance": g for s, g in zip(("top", "bottom"), gauges, strict=True)},
            {"top-left": {"resistance": film}, "bottom-right": {}},
            length=LENGTH,
            width=width,
            rows=pixels[0],
            columns=pixels[1],
            top=SHEET,
            bottom=SHEET,
            c=C,
            **keywords,
        )

    return opposite


def by_triangles(scene, press, rtol):
    """Z refined where it is least certain, whatever the coefficients."""
    finer = Triangles(
        scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, rtol
    )
    while True:
        rung = finer.finer(scene.frequencies).result(scene.frequencies, rtol)
        if rung.error.max() <= rtol:
            return rung.Z


@pytest.mark.parametrize(("gauges", "film", "width", "pixels", "press", "u", "rtol"), BY_CHANCE)
def test_orders_that_agree_by_chance_do_not_pass(
    opposite, frequency_at, off, gauges, film, width, pixels, press, u, rtol
):
    """In cells far wider than the layers every second order hardly changes the answer."""
    at_rest = opposite(gauges, film, width, pixels)
    scene = opposite(gauges, film, width, pixels, frequencies=frequency_at(at_rest, u).tolist())
    press = parse_press(press, 2.0)
    answer = Solver(scene.parts, rtol).solve(press)
    true = off(answer.Z, by_triangles(scene, press, rtol / 30))
    assert (true <= np.stack(answer.relative_errors)).all()


def two_lines(segments, s):
    """Z of segments (r_t, r_b [ohm/m], c [F/m], length [m]) fed at their opposite ends by 1 A.

    (r_t + r_b) I_t = r_b I - V', V = A exp(-k x) + B exp(-k (l - x)), k² = s c (r_t + r_b); I_t is
    I at the left end and 0 at the right one, V and I_t are continuous.
    """
    r_t, r_b, c, length = np.array(segments).T
    R, count = r_t + r_b, len(segments)
    k = np.sqrt(s * c * R)
    e, one = np.exp(-k * length), np.ones(count)
    V = np.array([[one, e], [e, one]])
    I_t = np.array([[k, -k * e], [k * e, -k]]) / R
    left, right = 0, 1
    system = np.zeros((2 * count, 2 * count), dtype=complex)
    given = np.zeros(2 * count, dtype=complex)
    system[0, :2], given[0] = I_t[left, :, 0], 1 - r_b[0] / R[0]
    for n in range(count - 1):
        here, there = np.s_[2 * n : 2 * n + 2], np.s_[2 * n + 2 : 2 * n + 4]
        for row, form in ((2 * n + 1, V), (2 * n + 2, I_t)):
            system[row, here], system[row, there] = form[right, :, n], -form[left, :, n + 1]
        given[2 * n + 2] = r_b[n + 1] / R[n + 1] - r_b[n] / R[n]
    system[-1, -2:], given[-1] = I_t[right, :, -1], -r_b[-1] / R[-1]
    weights = np.linalg.solve(system, given).reshape(count, 2)
    start, stop = (np.einsum("en,ne->n", V[end], weights) for end in (left, right))
    through_top = (r_b * length - (stop - start)) / R
    return start[0] + (r_b * (length - through_top)).sum()


@pytest.mark.parametrize("u", [1e1, 1e3, 5e3])
def test_a_strip_of_gauges_is_two_lines(opposite, frequency_at, off, u):
    gauges, width, factor = (1.5, 0.4), 0.02, 3.0
    at_rest = opposite(gauges, 0.0, width, (1, 3))
    scene = opposite(gauges, 0.0, width, (1, 3), frequencies=frequency_at(at_rest, u).tolist())
    strain = 1 - 1 / factor
    segments = [(SHEET / width, SHEET / width, C * width, LENGTH / 3)] * 3
    pressed = [SHEET / width * (1 + gauge * strain) for gauge in gauges]
    segments[1] = (*pressed, factor * C * width, LENGTH / 3)
    Z = np.array([[two_lines(segments, s) for s in laplace_variable(scene.frequencies)]])
    answer = Solver(scene.parts, 1e-4).solve(parse_press("1,2:3", 2.0))
    assert (off(answer.Z, Z) <= np.stack(answer.relative_errors)).all()
