"""A few real solves give what a complex solve for each frequency gives."""

from itertools import islice

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.fem.error_estimate import lost_digits, relative_difference
from rcskin.simulator.fem.kernels import (
    continued_fraction,
    continued_fractions,
    last_change,
    next_convergent,
)
from rcskin.simulator.fem.lanczos import Pencil, coefficients, last_change_readable, respond
from rcskin.simulator.fem.terminals import Network
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.sweeps import parallel_capacitance
from scipy.sparse.linalg import splu


def fraction_written_out(t, diagonal, squared, steps):
    """e1'(I + t T)^-1 e1 with the tridiagonal T written out."""
    beside = np.sqrt(squared[1:steps])
    T = np.diag(diagonal[:steps]) + np.diag(beside, 1) + np.diag(beside, -1)
    return complex(np.linalg.inv(np.eye(steps) + t * T)[0, 0])


@pytest.mark.kernel
@given(steps=st.integers(1, 8), seed=st.integers(0, 2**32))
def test_the_fraction_is_that_of_the_matrix_written_out(steps, seed):
    rng = np.random.default_rng(seed)
    diagonal, squared = rng.uniform(0.1, 2, steps), rng.uniform(0.01, 0.1, steps)
    for t in 1j * np.geomspace(1e-3, 1e3, 7) - rng.uniform(0, 0.1):
        given = t, diagonal, squared, steps
        assert continued_fraction(*given) == pytest.approx(fraction_written_out(*given), rel=1e-10)


@pytest.mark.kernel
@given(steps=st.integers(1, 12), seed=st.integers(0, 2**32))
def test_fractions_side_by_side_are_those_one_by_one(steps, seed):
    rng = np.random.default_rng(seed)
    diagonal, squared = 10 ** rng.uniform(-9, 1, (2, steps))
    t = np.geomspace(1e-3, 1e9, 13) * np.exp(1j * rng.uniform(0, np.pi, 13))
    one_by_one = [continued_fraction(complex(each), diagonal, squared, steps) for each in t]
    parts, found = np.stack([t.real, t.imag, (t * t).real, (t * t).imag]), np.empty((2, len(t)))
    continued_fractions(parts, diagonal, squared, steps, found)
    np.testing.assert_allclose(found[0] + 1j * found[1], one_by_one, rtol=1e-12)


@pytest.mark.kernel
@given(steps=st.integers(1, 12), seed=st.integers(0, 2**32))
def test_each_convergent_is_the_fraction_to_that_step(steps, seed):
    rng = np.random.default_rng(seed)
    diagonal, squared = rng.uniform(0.1, 2, steps), rng.uniform(0.01, 0.1, steps)
    for t in 1j * np.geomspace(1e-3, 1e3, 7) - rng.uniform(0, 0.1):
        convergent = 0.0j, 1.0 + 0.0j, 0.0j, 0.0j
        for step in range(steps):
            convergent = next_convergent(
                convergent, complex(t), diagonal[step], squared[step], step
            )
            P, Q, *_ = convergent
            assert abs(Q) == pytest.approx(1.0)
            expected = continued_fraction(complex(t), diagonal, squared, step + 1)
            assert P * Q.conjugate() == pytest.approx(expected, rel=1e-9)


@pytest.mark.kernel
@given(steps=st.integers(2, 8), seed=st.integers(0, 2**32))
def test_the_last_change_is_that_of_Rs_or_Cp(steps, seed):
    rng = np.random.default_rng(seed)
    diagonal, squared = rng.uniform(0.1, 2, steps), rng.uniform(0.01, 0.1, steps)
    s, shift = 1j * np.geomspace(1e-2, 1e2, 5), rng.uniform(0, 0.1)
    at_once = rng.normal(size=5) + 2j + s
    Y, change = last_change(s, shift, at_once, diagonal, squared, steps)
    after, before = (
        at_once
        - (s - shift) ** 2
        * squared[0]
        * [fraction_written_out(t, diagonal, squared, m) for t in s - shift]
        for m in (steps, steps - 1)
    )
    np.testing.assert_allclose(Y, after, rtol=1e-12)
    expected = relative_difference(1 / before, 1 / after).max(axis=0)
    np.testing.assert_allclose(change, expected, rtol=1e-6, atol=1e-13)


@given(steps=st.integers(1, 12), seed=st.integers(0, 2**32))
def test_python_reads_the_last_change_to_the_same_bits(steps, seed):
    rng = np.random.default_rng(seed)
    diagonal, squared = 10 ** rng.uniform(-9, 9, (2, steps))
    s, shift = 1j * np.geomspace(1e-3, 1e7, 9), rng.uniform(0, 1e3)
    given = s, shift, rng.normal(size=9) + 1j * rng.normal(size=9), diagonal, squared, steps
    for compiled, read in zip(last_change(*given), last_change_readable(*given), strict=True):
        np.testing.assert_array_equal(compiled, read)


def looking_at_all(pencil, s, rtol, most_steps):
    """Y and error of `respond`, every step judged at every frequency."""
    t, diagonal, squared = s - pencil.shift, [], []
    at_once = pencil.admittance + t * pencil.capacitance
    changes, Y = [np.full(len(s), np.inf)], at_once
    for b, a, _ in islice(coefficients(pencil), most_steps):
        squared.append(b)
        diagonal.append(a)
        if len(squared) >= 3 or len(squared) == most_steps:
            given = s, pencil.shift, at_once, np.array(diagonal), np.array(squared), len(squared)
            Y, change = last_change(*given)
            changes.append(change)
            if max(each.max() for each in changes[-2:]) <= rtol:
                break
    else:
        if len(squared) < most_steps:
            changes = [np.zeros(len(s))] * 2
            given = s, pencil.shift, at_once, np.array(diagonal), np.array(squared), len(squared)
            Y = last_change(*given)[0] if squared else at_once
    return Y, np.maximum(*changes[-2:]) + lost_digits(Y, at_once)


@given(
    seed=st.integers(0, 2**32),
    size=st.integers(1, 12),
    most_steps=st.integers(1, 14),
    digits=st.integers(1, 12),
)
def test_frequencies_not_looked_at_while_the_farthest_changes_would_not_have_ended_it(
    seed, size, most_steps, digits
):
    random = np.random.default_rng(seed)
    mass, start = 10 ** random.uniform(-6, 0, size), random.normal(size=size)
    pencil = Pencil(start, lambda v: mass * v, np.copy, 1.0, 1.0, random.uniform(0, 10))
    s = 1j * np.geomspace(1, 1e4, 7) * np.exp(1j * random.uniform(-1, 0))
    some = pencil, random.permutation(s), 10.0**-digits, most_steps
    for found, expected in zip(respond(*some), looking_at_all(*some), strict=True):
        np.testing.assert_array_equal(found, expected)


ROUNDING = np.finfo(np.longdouble).eps
"""Of extended precision."""


def complex_solves(sheet, press, frequency):
    """As `Sheet.impedance`, with residuals in extended precision: in double the difference of the
    two terms of Y loses up to six digits far above cut-off."""
    space, s = sheet.space, laplace_variable(frequency, sheet.skin.foam.loss)
    mass = space.restricted(sheet.mass(press))
    lift = space.lift.astype(np.clongdouble)
    charge = mass.astype(np.clongdouble) @ lift
    inside, delayed = charge[: space.inner], []
    for each in s:
        matrix, x = (space.K + each * space._inner(mass)).tocsc(), np.zeros_like(inside)
        factors, finely = splu(matrix), matrix.astype(np.clongdouble)
        for _ in range(5):
            change = factors.solve((inside - finely @ x).astype(complex))
            x += change
            if (abs(change).max(axis=0) <= ROUNDING * abs(x).max(axis=0)).all():
                break
        delayed.append(inside.T @ x)
    s = s[:, None, None]
    dynamic = (s * (lift.T @ charge) - s**2 * np.array(delayed)).astype(complex)
    network = Network(space.terminal_field, space.conductance, dynamic)
    return np.stack([network.impedance(excitation) for excitation in sheet.circuit.excitations])


@settings(max_examples=8)
@given(data=st.data())
def test_against_complex_solves(random, frequency_at, data):
    """From where the skin is one capacitor to where the field reaches a hundredth of it."""
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    frequency = frequency_at(scene, np.geomspace(1e-4, 1e4, 5))
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=3, layers=2),
    )
    ((Z, change),) = sheet.sweep(press, frequency, 1e-9)
    difference = relative_difference(Z, complex_solves(sheet, press, frequency))
    low = frequency < frequency_at(scene, 200)
    assert (difference <= change + 1e-9)[..., low].all()
    assert change.max() <= 2e-9
    assert difference.max() <= 1e-6


@pytest.mark.parametrize("resistance", [0.0, 1e3, pytest.param(1e7, marks=pytest.mark.slow)])
def test_no_digits_are_lost_far_above_cut_off(make_scene, frequency_at, resistance):
    """A film of contact resistance and the line in series: exact, at each end of a wide band."""
    bottom = {"resistance": 0.6 * resistance}
    scene = make_scene({"top-left": {"resistance": resistance}, "bottom-left": bottom})
    frequency = frequency_at(scene, np.geomspace(1e-6, 1e4, 6))
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=12, cells=2, edge_cell=1e-3),
    )
    ((Z, _),) = sheet.sweep(Press(), frequency, 1e-11)
    exact = Line(scene.parts.skin, scene.parts.setup).solve(Press(), frequency).Z
    assert relative_difference(Z, exact).max() <= 1e-8


@given(data=st.data())
def test_against_complex_solves_where_direct_current_may_flow(random, frequency_at, data):
    """Cp may then be nothing but rounding: Z as a whole is compared."""
    scene = data.draw(random.across())
    frequency = frequency_at(scene, np.geomspace(1e-3, 1e2, 5))
    sheet = SheetModel(
        scene.parts.skin,
        two_fields(scene.parts.skin, scene.parts.setup),
        Resolution(order=3),
    )
    ((Z, _),) = sheet.sweep(Press(), frequency, 1e-9)
    np.testing.assert_allclose(Z, sheet.impedance(Press(), frequency), rtol=1e-7)


@settings(max_examples=5)
@given(data=st.data())
def test_lower_orders_are_nested_in_higher_ones(random, frequency_at, data):
    scene = data.draw(random.between())
    press = data.draw(random.presses(scene))
    frequency = frequency_at(scene, [0.1, 10.0])
    circuit = one_field(scene.parts.skin, scene.parts.setup) or two_fields(
        scene.parts.skin, scene.parts.setup
    )
    high, low = (
        SheetModel(scene.parts.skin, circuit, Resolution(order, layers=2)) for order in (5, 4)
    )
    ((Z, _),) = high.sweep(press, frequency, 1e-9, high.nested)
    np.testing.assert_allclose(Z, low.impedance(press, frequency), rtol=1e-8)


@given(data=st.data(), steps=st.integers(1, 12))
def test_any_step_is_passive_and_no_step_loses_capacitance(random, frequency_at, data, steps):
    """Galerkin in a real space: Re Z >= 0, Im Z <= 0, Rs and Cp fall with frequency."""
    scene = data.draw(random.between())
    press, circuit = (
        data.draw(random.presses(scene)),
        two_fields(scene.parts.skin, scene.parts.setup),
    )
    sheet = SheetModel(scene.parts.skin, circuit, Resolution(order=2))
    frequency = frequency_at(scene, np.geomspace(1e-2, 1e4, 30))
    pencil = sheet.space.pencil(sheet.mass(press), circuit.excitations[0], 0.0)
    Y, _ = respond(pencil, 2j * np.pi * frequency, 1e-300, most_steps=steps)
    Z = 1 / Y
    Cp = parallel_capacitance(Z, frequency)
    assert (Z.real >= 0).all() and (Z.imag <= 0).all()
    assert (np.diff(Z.real) <= 1e-9 * Z.real[:-1]).all()
    assert (np.diff(Cp) <= 1e-9 * Cp[:-1]).all()


@pytest.mark.parametrize("size", [1, 2, 3, 4, 9])
def test_small_systems_are_exact_when_their_space_is_exhausted(size):
    """Y_0 + s c - s² b'(K + s M)^-1 b for matrices written out."""
    rng = np.random.default_rng(size)
    half = rng.normal(size=(2, size, size))
    K, M = half[0] @ half[0].T + np.eye(size), half[1] @ half[1].T
    b, s = rng.normal(size=size), 1j * np.geomspace(1e-2, 1e2, 5)
    inverse = np.linalg.inv(K)
    Y, change = respond(Pencil(b, M.dot, inverse.dot, 0.3, 50.0, 0.0), s, 1e-12)
    exact = [0.3 + 50.0 * each - each**2 * b @ np.linalg.solve(K + each * M, b) for each in s]
    np.testing.assert_allclose(Y, exact, rtol=1e-8)
    assert change.max() < 1e-6
