"""The bound on position: additivity, symmetries, and an estimate that reaches it."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.likelihood import error_model
from rcskin.simulator.bounds.position_bound import chosen_touch, place_likelihood, places_on
from rcskin.simulator.limits import position_bound
from rcskin.simulator.measure.readout import observed
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.sweeps import InputError
from scipy.optimize import least_squares

LEFT, BOTTOM = ("top-left", "bottom-left"), ("top-bottom", "bottom-bottom")
TWO_PAIRS = (*LEFT, *BOTTOM)
TRIALS = 150


def slopes_of(scene, most=4, **options):
    touch = chosen_touch(scene.parts.skin, scene.press)
    fields = FullFields(scene.parts, float(scene.frequencies[-1]))
    places = places_on(scene.parts.skin, touch, fields.cells, most)
    return place_likelihood(fields, places, touch, scene.frequencies, **options)


def square_of(noisy, **more):
    return noisy(
        contacts={name: {"span": (0.1, 1.0)} for name in TWO_PAIRS},
        interfaces={"left": LEFT, "bottom": BOTTOM},
        length=0.1,
        width=0.1,
        bottom=50e3,
        rows=3,
        columns=3,
        frequencies=np.geomspace(1e3, 1e5, 6).tolist(),
        **more,
    )


@pytest.fixture(scope="module")
def square(noisy):
    return square_of(noisy)


@pytest.fixture(scope="module")
def drifting(noisy):
    return square_of(noisy, accuracy=True)


def test_n_repeated_readings_divide_the_bound_by_root_n(square):
    once = slopes_of(square)
    four = replace(once, readings=once.readings.some(frequencies=4 * [*range(6)]))
    for name in ("x", "y", "strength"):
        single, repeated = (getattr(each.bounds(), name) for each in (once, four))
        np.testing.assert_allclose(repeated, single / 2, rtol=1e-6)


def test_more_readings_are_never_worse(drifting):
    slopes = slopes_of(drifting)
    fewer, f = slopes.bounds(slopes.frequency[:3]), slopes.frequency
    for more in (slopes.bounds(f[:4]), slopes.bounds(f), slopes.bounds()):
        for name in ("x", "y", "strength"):
            assert (getattr(more, name) <= getattr(fewer, name) * (1 + 1e-9)).all()
        fewer = more
    alone = slopes.bounds(interfaces=[0])
    assert (fewer.x <= alone.x).all() and (fewer.y <= alone.y).all()


def test_unknowns_increase_the_bound_and_a_baseline_decreases_it(square, drifting):
    known, unsure = slopes_of(square).bounds(), slopes_of(square, unknown_skin=True).bounds()
    assert (unsure.x > known.x).all() and (unsure.strength > known.strength).all()
    alone = slopes_of(drifting, unknown_skin=True).bounds()
    compared = slopes_of(drifting, unknown_skin=True, against_rest=100).bounds()
    assert np.median(compared.x) < np.median(alone.x)


def test_interfaces_at_two_edges_swap_x_and_y(square):
    bounds = slopes_of(square).bounds()
    mirrored = bounds.x.reshape(4, 4).T.ravel()
    np.testing.assert_allclose(bounds.y, mirrored, rtol=1e-4)


def test_one_edge_has_symmetric_bounds_and_does_not_resolve_y_in_the_middle(noisy):
    fine = {"magnitude_noise": 1e-5, "phase_noise": 1e-5}
    frequencies = np.geomspace(1e3, 1e5, 6).tolist()
    scene = noisy(readout=fine, rows=3, columns=3, frequencies=frequencies)
    touch, fields = chosen_touch(scene.parts.skin, scene.press), FullFields(scene.parts, 1e5)
    middle, width = scene.skin.width / 2, scene.skin.width
    places = [(0.04, 0.018), (0.04, width - 0.018), (0.04, middle)]
    low, high, half = place_likelihood(fields, places, touch, scene.frequencies).bounds().y
    assert low == pytest.approx(high, rel=1e-6)
    assert np.isinf(half) and np.isfinite(low)


def test_maximum_likelihood_on_the_exact_line_reaches_the_bound(noisy):
    scene = noisy(
        accuracy=True,
        length=0.1,
        width=0.02,
        columns=3,
        frequencies=np.geomspace(1e3, 3e4, 6).tolist(),
    )
    touch, x = chosen_touch(scene.parts.skin, scene.press), 0.0375
    slopes = place_likelihood(FullFields(scene.parts, 3e4), [(x, 0.01)], touch, scene.frequencies)
    bounds = slopes.bounds()
    assert np.isinf(bounds.y).all()
    line, model = (
        Line(scene.parts.skin, scene.parts.setup),
        error_model(scene.parts.setup, scene.parts.meter, scene.frequencies),
    )

    def read(values):
        press = Press((Rectangle(values[0], 0.01, touch.width, 0.02, 1 + values[1]),))
        return model.whitened(observed(line.solve(press, scene.frequencies).Z))

    random, truth = np.random.default_rng(3), read((x, touch.rise))

    def estimate(shown):
        return least_squares(
            lambda values: read(values) - shown, (x, touch.rise), x_scale=(1e-3, 0.1)
        ).x

    noise = random.standard_normal((TRIALS, truth.size))
    estimates = [estimate(truth + each) for each in noise]
    ratio = np.std(estimates, axis=0) / (bounds.x[0], bounds.strength[0])
    np.testing.assert_allclose(ratio, 1, atol=4 / np.sqrt(2 * TRIALS))


def test_the_bound_is_one_call_and_has_the_range_of_positions(square):
    bounds = position_bound(square.parts, size=0.02, max_places=3)
    assert bounds.places.shape == (9, 2) and (bounds.places >= 0.01 - 1e-9).all()
    assert 0 < bounds.median_error() < 0.1


@pytest.mark.parametrize("given", [{"size": 0.0}, {"size": 0.2}, {"factor": 1.0}, {"factor": -1}])
def test_invalid_touches_are_refused(square, given):
    with pytest.raises(InputError, match="must be"):
        chosen_touch(square.parts.skin, square.press, **given)
