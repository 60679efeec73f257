"""The separable model: what it leaves out, what it owns up to, and the laws that it keeps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.separable import model as separable
from rcskin.simulator.models.separable.kernel import swept
from rcskin.simulator.models.separable.model import Separable
from rcskin.simulator.models.separable.modes import interval, side, swept_readable
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.pieces import pieces, random_presses
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.sweeps import InputError, ToleranceError

FREQUENCY = np.geomspace(40, 200e3, 20)
EDGES = ("left", "right", "bottom", "top")


def at(scene, frequency):
    """The scene swept over these frequencies."""
    sweep = scene.sweep.model_copy(update={"frequencies": tuple(frequency)})
    return scene.model_copy(update={"sweep": sweep})


def apart(Z, truth, frequency=FREQUENCY):
    """Relative differences of Rs and Cp, shape (2, ..., frequency)."""
    return relative_difference(Z, truth, 2 * np.pi * frequency)


@pytest.fixture(scope="module")
def sheet():
    return at(load_scene("sheet-5x5"), FREQUENCY)


@pytest.fixture(scope="module")
def model(sheet):
    return Separable(sheet, 1e-4)


@st.composite
def skins(draw, make_scene, frequency_at):
    """Skins with whole foils on some edges, ideal or under a film, and lossy foam."""
    edges = draw(st.lists(st.sampled_from(EDGES), unique=True, min_size=1, max_size=4))
    ideal = len(edges) > 1 and draw(st.booleans())
    foils, top, bottom = {}, 50e3, 30e3
    for edge in edges:
        r = 0.0 if ideal else draw(st.sampled_from([0.0, 1.0, 300.0]))
        foils[f"top-{edge}"] = {"resistance": r}
        foils[f"bottom-{edge}"] = {"resistance": r * bottom / top}
    meter = {"meter": tuple([n for n in foils if n.startswith(s)] for s in ("top", "bottom"))}
    size = {name: draw(st.floats(0.03, 0.2)) for name in ("length", "width")}
    scene = make_scene(foils, meter, loss_tangent=draw(st.sampled_from([0.0, 0.05])), **size)
    u = draw(st.floats(0.1, 10))
    return at(scene, frequency_at(scene, np.geomspace(u / 100, u, 5)))


@given(
    start=st.sampled_from([0.0, 3.0, 1e5, np.inf]), stop=st.sampled_from([0.0, 0.1, 40.0, np.inf])
)
def test_modes_are_orthonormal_and_meet_their_ends(start, stop):
    modes = side(0.12, start, stop, 12)
    np.testing.assert_allclose(interval(modes, 0.0, 0.12)[0], np.eye(12), atol=1e-10)
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = 0.03 + 0.04 * (x + 1) / 2, 0.02 * w
    phi = modes.amplitude * np.cos(np.multiply.outer(x, modes.wavenumber) - modes.phase)
    product, linear = interval(modes, 0.03, 0.07)
    np.testing.assert_allclose(product, phi.T @ (w[:, None] * phi), atol=1e-10)
    np.testing.assert_allclose(linear, w @ phi, atol=1e-10)
    for h, x, sign in ((start, 0.0, -1), (stop, 0.12, 1)):
        angle = modes.wavenumber * x - modes.phase
        value, slope = np.cos(angle), -modes.wavenumber * np.sin(angle)
        off = value if h == np.inf else (sign * slope + h * value) / (1 + h + modes.wavenumber)
        np.testing.assert_allclose(off, 0.0, atol=1e-9)


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5])
def test_rectangles_anywhere_keep_the_tolerance(sheet, rtol):
    presses = random_presses(sheet, np.random.default_rng(5), 6)
    solver = Solver(sheet, 1e-8)
    truth = np.stack([solver.solve(press).Z for press in presses])
    Z = Separable(sheet, rtol).impedances(presses, FREQUENCY)
    assert apart(Z, truth).max() < rtol


@settings(max_examples=6)
@given(data=st.data())
def test_any_whole_foils(make_scene, frequency_at, data):
    scene = data.draw(skins(make_scene, frequency_at))
    model, f = Separable(scene, 1e-4), scene.frequencies
    seed = data.draw(st.integers(0, 1000))
    for press in [Press(), *random_presses(scene, np.random.default_rng(seed), 2)]:
        truth = Solver(scene, 1e-6).solve(press).Z
        assert apart(model.impedance(press, f), truth, f).max() < 1e-4


@pytest.mark.parametrize(
    "text",
    [
        "1,1:3+2,3:0.6",
        "rect(0.03,0.04,0.03,0.02):2+rect(0.04,0.04,0.03,0.05):1.4+2,2:1.2",
        "rect(0.04,0.05,0.024,0.024):1.5+rect(0.05,0.05,0.03,0.03):2",
    ],
)
def test_touches_of_every_kind_and_over_each_other(sheet, model, text):
    press = parse_press(text, 2.0)
    truth = Solver(sheet, 1e-6).solve(press).Z
    assert apart(model.impedance(press, FREQUENCY), truth).max() < 1e-4


@pytest.mark.parametrize("text", ["none", "rect(0.03,0.06,0.02,0.12):3"])
def test_what_does_not_vary_across_is_the_exact_line(sheet, model, text):
    press = parse_press(text, 2.0)
    truth = Line(sheet).impedance(press, FREQUENCY)
    assert apart(model.impedance(press, FREQUENCY), truth).max() < 1e-4
    finer = Separable(sheet, 1e-4, size=2000)
    assert apart(finer.impedance(press, FREQUENCY), truth).max() < 1e-5


@settings(max_examples=10)
@given(data=st.data(), size=st.integers(3, 60))
def test_the_kernel_does_what_is_written_out(make_scene, frequency_at, data, size):
    scene = data.draw(skins(make_scene, frequency_at))
    products = Separable(scene, 1e-4, size).products
    presses = [Press(), *random_presses(scene, np.random.default_rng(2), 3)]
    s = laplace_variable(scene.frequencies, scene.skin.foam.loss)
    touched = pieces(scene, presses)
    np.testing.assert_allclose(
        swept(products, *touched, s, 1e-14),
        swept_readable(products, *touched, s, 1e-14),
        rtol=1e-10,
    )


def test_lanczos_ends_within_its_share(sheet, model):
    presses = random_presses(sheet, np.random.default_rng(8), 100)
    s = laplace_variable(FREQUENCY)
    touched = pieces(sheet, presses)
    early, late = (swept(model.products, *touched, s, rtol) for rtol in (1e-5, 1e-14))
    assert apart(1 / early, 1 / late).max() < 1e-5


@settings(max_examples=8)
@given(data=st.data())
def test_the_certificate_bounds_the_error_closely(make_scene, frequency_at, data):
    scene = data.draw(skins(make_scene, frequency_at))
    f, rng = scene.frequencies, np.random.default_rng(data.draw(st.integers(0, 1000)))
    coarse, fine = Separable(scene, 1e-3, 60), Separable(scene, 1e-9, 4000)
    weak = parse_press(f"rect({scene.skin.length / 3!r},{scene.skin.width / 2!r},0.01,0.01):0.4", 2)
    for press in [weak, *random_presses(scene, rng, 2)]:
        error = apart(coarse.impedance(press, f), fine.impedance(press, f), f)
        bound = coarse.certificate(press, f)
        assert (bound >= error).all()
        assert bound.max() < 30 * error.max()


def test_low_frequency_loses_no_digits(sheet, model):
    """Cp is the whole capacitance, and Rs no longer changes."""
    (press,) = random_presses(sheet, np.random.default_rng(6), 1)
    frequency = np.array([1e-4, 1e-3, 1e-1])
    Z = model.impedance(press, frequency)[0]
    touch, skin = press.touches[0], sheet.skin
    area = skin.length * skin.width + (touch.factor - 1) * touch.width * touch.height
    whole = skin.foam.rest_capacitance_per_area * area
    np.testing.assert_allclose((1 / Z).imag / (2 * np.pi * frequency), whole, rtol=1e-9)
    np.testing.assert_allclose(Z.real, Z.real[0], rtol=1e-6)


def test_passivity(model):
    """Rs and Cp fall with frequency, the phase stays between -90 and 0 degrees."""
    frequency = np.geomspace(1, 1e8, 60)
    for press in random_presses(model.scene, np.random.default_rng(3), 5):
        Z = model.impedance(press, frequency)[0]
        Rs, Cp = Z.real, (1 / Z).imag / (2 * np.pi * frequency)
        assert (Z.real > 0).all() and (Z.imag < 0).all()
        assert (np.diff(Rs) <= 1e-9 * Rs[0]).all() and (np.diff(Cp) <= 1e-9 * Cp[0]).all()


def test_a_batch_is_its_presses_one_by_one_to_the_bit(model):
    presses = [Press(), *random_presses(model.scene, np.random.default_rng(4), 5)]
    together = model.impedances(presses, FREQUENCY)
    alone = np.stack([model.impedance(press, FREQUENCY) for press in presses])
    np.testing.assert_array_equal(together, alone)
    assert model.impedances([], FREQUENCY).shape == (0, 1, 20)


def test_frequencies_may_be_asked_in_any_order(model):
    (press,) = random_presses(model.scene, np.random.default_rng(4), 1)
    backwards = model.impedance(press, FREQUENCY[::-1])[:, ::-1]
    np.testing.assert_array_equal(backwards, model.impedance(press, FREQUENCY))


def test_what_it_is_is_told(model):
    assert "products of" in model.explain()
    assert "on 200 random presses, asked 0.0001" in model.explain()


@pytest.mark.parametrize(
    ("foils", "meter", "told"),
    [
        ({"top-left": {}, "bottom-right": {}}, None, "not fed in pairs"),
        (
            {"top-left": {"span": (0.0, 0.5)}, "bottom-left": {"span": (0.0, 0.5)}},
            None,
            "contact 'top-left' takes only part of an edge",
        ),
        (
            {"top-left": {}, "bottom-left": {}, "top-right": {}, "bottom-right": {}},
            {"meter": ("top-left", "bottom-left")},
            "foils float at one of its interfaces",
        ),
    ],
)
def test_scenes_that_are_not_separable_are_told(make_scene, foils, meter, told):
    with pytest.raises(InputError, match=told):
        Separable(make_scene(foils, meter))


def test_a_tolerance_out_of_reach_is_told(sheet, monkeypatch):
    monkeypatch.setattr(separable, "SIZES", [24, 30])
    with pytest.raises(InputError, match="`rtol` must be finite and > 0, got 0"):
        Separable(sheet, 0)
    with pytest.raises(ToleranceError, match="products leave out .* asked 1e-12"):
        Separable(sheet, 1e-12)
