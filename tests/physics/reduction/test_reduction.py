"""Reduced models: as accurate as requested and as certified, passive, and free in what they
promise."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.fem.lanczos import Pencil, respond
from rcskin.simulator.models.parameters import HALF_WAVES, Variation, mode_values, nominal
from rcskin.simulator.models.reduced.cases import Case, pixel_touches
from rcskin.simulator.models.reduced.certificate import largest_bounds
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load
from rcskin.simulator.models.small_system.lanczos import SINGLE_RTOL
from rcskin.simulator.models.small_system.system import mass_of, widened
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.frequency import LOSSLESS, Loss
from rcskin.simulator.sweeps import InputError, ToleranceError

RTOL = 1e-5
FED = ("one field", "crossed", "floating foils", "films", "a floating sheet", "a floating body")


@pytest.fixture(scope="module")
def families(library):
    """One reduced model of every kind of contacts."""
    return {name: library.model(name) for name in FED}


def batch(cases):
    return PressBatch.of((case.cells, case.rises) for case in cases)


def error(Z, truth, scene):
    return relative_difference(Z, truth).max()


def drawn(parts, count, seed=7):
    random, draw = np.random.default_rng(seed), pixel_touches(parts.skin, parts.plan)
    return [draw(random) for _ in range(count)]


@pytest.mark.parametrize("name", FED)
def test_the_certificate_bounds_what_the_reduction_leaves_out(families, name):
    """A model of too few vectors is far off, and says so: within a factor of the truth."""
    full = families[name]
    few = full.size // 2
    kept = [*range(len(full.conductance)), *range(-few, 0)]
    reduced = replace(
        full,
        basis=full.basis[:, -few:],
        stiffness=full.stiffness[:, : len(kept), : len(kept)],
        factors=full.factors[:, :, kept],
        fixed=np.array([M[np.ix_(kept, kept)] for M in full.fixed]),
    )
    own, frequency = reduced.at(None), reduced.frequency
    ratios = []
    for case in drawn(full.parts, 6):
        Z = own.sweep(case.cells, case.rises)
        exact = own.exact(case.cells, case.rises)
        true = relative_difference(Z, exact)
        bound = own.certificate(case.cells, case.rises)
        worth = true > 1e-7
        assert (true[worth] <= bound[worth]).all()
        np.testing.assert_allclose(largest_bounds(reduced, [case], frequency), bound.max(), 1e-6)
        ratios.extend(bound[worth] / true[worth])
    assert ratios
    assert np.median(ratios) < 30


def pencil_of(mass, feed):
    """K + s M of one excitation."""
    terminals = len(feed.driven)
    driven, tied, common = (
        widened(each, len(mass)) for each in (feed.driven[None], feed.tied, feed.common)
    )

    def neutral(v):
        charge = common @ mass
        return v - common.T @ np.linalg.solve(charge @ common.T, charge @ v)

    def inverse(y):
        v = np.concatenate([np.zeros(terminals), y[terminals:]])
        return neutral(v + tied.T @ (feed.tied_inverse @ (tied @ y)))

    potential = neutral(driven[0])
    start = mass @ potential
    return Pencil(start, mass.dot, inverse, feed.conductance, float(potential @ start), 0.0)


def swept(skin, batch, rtol):
    """Y in S of each excitation under many presses, shape (press, s)."""
    own, every = skin.alone._replace(rtol=np.array([rtol])), np.arange(batch.count)
    return [own.admittances(feed, batch, 0 * every, every) for feed in skin.excited_alone]


def swept_readable(skin, batch, rtol):
    masses = [mass_of(skin.unpressed_mass, *touched) for touched in batch.each()]
    return [
        np.stack([respond(pencil_of(mass, feed), skin.s, rtol)[0] for mass in masses])
        for feed in skin.dense_excitations
    ]


@pytest.mark.kernel
def test_the_kernel_and_its_readable_twin_agree(families):
    for reduced in families.values():
        given = reduced.at(None), batch(drawn(reduced.parts, 4)), 1e-13
        np.testing.assert_allclose(swept(*given), swept_readable(*given), rtol=1e-11)


@pytest.mark.kernel
def test_single_precision_is_taken_where_the_tolerance_is_far_above_its_errors(families):
    rounding, every = SINGLE_RTOL / 3, np.arange(4)
    for reduced in families.values():
        own, presses = reduced.at(None), batch(drawn(reduced.parts, 4))
        tight, loose = (own.alone._replace(rtol=np.array([rtol])) for rtol in (1e-6, 2e-5))
        assert tight.rounded() is tight
        loose = loose.rounded()._replace(rtol=tight.rtol)
        for feed in own.excited_alone:
            single, double = (
                1 / each.admittances(feed, presses, 0 * every, every) for each in (loose, tight)
            )
            difference = relative_difference(single, double).max()
            assert 0 < difference < rounding


@pytest.mark.parametrize("touches", [0, 1, 6], ids="{} touched".format)
def test_the_potentials_of_a_certificate_are_those_of_the_sweep(families, touches):
    """Presses of few touches, and of so many that M is diagonalised."""
    cells, rises = np.arange(touches), np.linspace(0.4, 2.0, touches)
    for reduced in families.values():
        own = reduced.at(None)
        found = swept(own, PressBatch.of([(cells, rises)]), 1e-13)
        factors = own.parts.pressed(cells, rises)[: len(reduced.factors)]
        M = np.einsum("k,krm,krn->mn", factors, reduced.factors, reduced.factors)
        M += sum(reduced.fixed)
        for (truth,), (u, Y) in zip(found, own.solved(cells, rises, own.s), strict=True):
            np.testing.assert_allclose(Y, truth, rtol=1e-9)
            inner = (own.stiffness @ u + own.s * (M @ u))[len(reduced.conductance) :]
            assert np.abs(inner).max() < 1e-9 * np.abs(Y).max()


def varied(scene, random, modes, same_sheets):
    """A skin whose sheets, films, foam and loss are all off by some per cent."""

    def sheet():
        return random.uniform(0.8, 1.2) * np.r_[1.0, random.uniform(-0.05, 0.05, modes - 1)]

    top = sheet()
    pixels = scene.pixels
    return Variation(
        top,
        1.1 * top if same_sheets else sheet(),
        np.full(len(scene.contacts), random.uniform(0.8, 1.2))
        if same_sheets
        else random.uniform(0.8, 1.2, len(scene.contacts)),
        random.uniform(0.9, 1.1, (pixels.rows, pixels.columns)),
        Loss(random.uniform(0.0, 0.05)),
    )


@pytest.mark.parametrize(
    ("name", "same_sheets"), [("one field", True), ("one field", False), ("films", False)]
)
def test_skins_of_a_family(library, name, same_sheets):
    """Sheets, their slow variation, films, foam and loss are free, without another basis."""
    scene, modes = library.scene(name), len(HALF_WAVES)
    touch = pixel_touches(scene.parts.skin, scene.parts.plan)

    def draw(random):
        case = touch(random)
        return Case(varied(scene, random, modes, same_sheets), case.cells, case.rises)

    reduced = reduce(scene.parts, RTOL, draw, modes=modes, same_sheets=same_sheets)
    random = np.random.default_rng(3)
    for _ in range(4):
        case = draw(random)
        own = reduced.at(case.variation)
        exact, Z = own.exact(case.cells, case.rises), own.sweep(case.cells, case.rises)
        assert error(Z, exact, scene) <= own.certificate(case.cells, case.rises).max() + 1e-6
        assert error(Z, exact, scene) <= RTOL


@pytest.mark.parametrize("name", ["one field", "films"])
def test_a_uniform_variation_is_the_scene_with_other_numbers(library, families, name):
    scene, reduced = library.scene(name), families[name]
    top, bottom, films, c = 1.25, 0.8, 1.6, 1.1
    other = scene.with_(
        {
            "skin.top.sheet_resistance": 50e3 / top,
            "skin.bottom.sheet_resistance": 30e3 / bottom,
            "skin.foam.capacitance_per_area": 5e-9 * c,
        }
    )
    resistances = tuple(
        contact.model_copy(update={"resistance": contact.resistance / films})
        for contact in other.contacts
    )
    other = other.model_copy(update={"contacts": resistances})
    uniform = Variation(
        np.array([top]), np.array([bottom]), np.full(2, films), np.full((2, 3), c), LOSSLESS
    )
    none = np.zeros(0, dtype=np.int64)
    exact = reduced.at(uniform).exact(none, np.zeros(0))
    truth = Solver(other.parts, 1e-8).solve(Press()).Z
    assert error(exact, truth, scene) <= 2 * RTOL


def test_common_factors_of_resistance_and_capacitance_only_shift_frequencies(families):
    """Z(f; a R, b C) = a Z(a b f; R, C) holds in the basis to rounding."""
    reduced = families["films"]
    a, b, modes = 2.0, 3.0, np.ones(1)
    scaled = reduced.at(
        Variation(modes / a, modes / a, np.full(2, 1 / a), np.full((2, 3), b), LOSSLESS)
    )
    shifted = replace(reduced, frequency=a * b * reduced.frequency)
    cases = drawn(reduced.parts, 3)
    Z, Z_shifted = scaled.sweeps(batch(cases)), shifted.at(None).sweeps(batch(cases))
    np.testing.assert_allclose(Z, a * Z_shifted, rtol=1e-6)


def test_slow_variation_is_a_cosine_of_conductance(make_scene):
    scene = make_scene()
    x = np.array([[0.0, 0.05, 0.10], [0.0, 0.04, 0.08]])
    np.testing.assert_allclose(
        mode_values(scene.parts.skin, x, 4),
        [[1, 1, 1], [1, 0, -1], [1, 0, -1], [1, 0, 1]],
        atol=1e-15,
    )
    with pytest.raises(InputError, match="`modes` must be between 1 and 4, got 5"):
        mode_values(scene.parts.skin, x, 5)


def test_the_face_of_every_model(families):
    """A press and frequencies in, Z out; a rectangle that is a pixel is that pixel."""
    reduced = families["crossed"]
    frequency = reduced.parts.setup.frequency
    pixel = Press((Touch(2, 1, 2.0),))
    skin = reduced.parts.skin
    width, height = skin.length / 3, skin.width / 2
    rectangle = Press((Rectangle(width / 2, 1.5 * height, width, height, 2.0),))
    Z = reduced.solve(pixel, frequency).Z
    np.testing.assert_allclose(reduced.solve(rectangle, frequency).Z, Z, rtol=1e-12)
    np.testing.assert_allclose(reduced.solve(pixel, frequency[1:]).Z, Z[:, 1:], rtol=1e-5)


def test_sheets_that_vary_differently_need_two_fields(families):
    reduced = replace(families["one field"], modes=2)
    own = nominal(reduced.parts.skin, 2)
    uneven = replace(own, top=np.array([1.0, 0.1]))
    with pytest.raises(InputError, match="need two fields"):
        reduced.at(uneven)


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "model.npz"
    path.write_text("no archive")
    with pytest.raises(InputError, match="model.npz: not a reduced model"):
        load(path)


def test_the_same_bits_on_a_second_run(library, families):
    again = reduce(library.scene("one field").parts, RTOL)
    np.testing.assert_array_equal(again.factors, families["one field"].factors)


def test_a_basis_that_grows_too_large_is_refused(library, monkeypatch):
    monkeypatch.setattr("rcskin.simulator.models.reduced.greedy.LARGEST", 5)
    with pytest.raises(ToleranceError, match=r"an error of .* with \d+ vectors, tolerance 1e-05"):
        reduce(library.scene("one field").parts, RTOL)
