"""Drift is followed by the latest sweeps at rest, and noise is averaged over more of them."""

import numpy as np
import pytest
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.learners.classifiers import curve_and_absolute
from rcskin.localization.learners.gaussians import FOLLOWED, fitted, fitted_correction
from rcskin.localization.parts.normal_densities import OPENING

FEATURES, SWEEPS, NOISE = 40, 4000, 0.01


def at_rest(random, way, drift=0.0, across=0.0):
    """The skin as it is, and means of the opening and of the latest sweeps at rest."""
    opened = random.standard_normal((SWEEPS, 1)) * way
    now = opened + drift * random.standard_normal((SWEEPS, 1)) * way + across
    noise = NOISE * random.standard_normal((2, SWEEPS, FEATURES))
    return now, opened + noise[0], now + noise[1]


def error(learned, now, opening, recent):
    """Root mean square of the reference that changes are told against, over the noise."""
    reference = recent - learned(recent - opening)
    return np.sqrt(np.square(reference - now).mean()) / NOISE


def test_noise_is_averaged_and_drift_is_followed():
    random = np.random.default_rng(1)
    way = random.standard_normal(FEATURES)
    _, opening, recent = at_rest(random, way)
    learned = fitted_correction(opening, recent, 1)
    averaged = np.sqrt(OPENING**2 + (1 - OPENING) ** 2)
    assert abs(error(learned, *at_rest(random, way)) - averaged) < 0.03
    assert abs(error(learned, *at_rest(random, way, drift=0.5)) - averaged) < 0.03


def test_noise_is_averaged_along_ways_that_neither_foam_nor_sheets_drift():
    random = np.random.default_rng(4)
    spread = np.diag([8.0, 4.0, 0.4, 0.2, *np.zeros(6)])
    opened = random.standard_normal((SWEEPS, 10)) @ spread
    drift = np.diag([0.08, 0.04, *np.zeros(8)])
    now = opened + random.standard_normal((SWEEPS, 10)) @ drift
    opening, still, recent = (
        each + NOISE * random.standard_normal(now.shape) for each in (opened, opened, now)
    )
    learned = fitted_correction(opening, still, FOLLOWED)
    averaged = (OPENING**2 + (1 - OPENING) ** 2) * 8 / 10 + 2 / 10
    assert error(learned, now, opening, recent) < np.sqrt(averaged) + 0.03


def test_a_skin_that_has_moved_far_in_another_way_is_compared_with_its_latest_rest():
    random = np.random.default_rng(2)
    way, other = random.standard_normal((2, FEATURES))
    _, opening, recent = at_rest(random, way)
    learned = fitted_correction(opening, recent, 1)
    assert error(learned, *at_rest(random, way, across=other)) < 1.1


def test_touches_are_found_better_with_the_sweeps_as_they_were_read():
    random = np.random.default_rng(3)
    way = random.standard_normal(FEATURES)

    def sweeps(drift):
        now, opening, recent = at_rest(random, way, drift)
        y = random.integers(0, 2, SWEEPS)
        sides = np.where(np.arange(FEATURES) < FEATURES // 2, -0.002, 0.002)
        touch = 0.5 + np.where(y[:, None], sides, -sides)
        read = now + touch + NOISE * random.standard_normal(now.shape)
        return np.hstack([read - recent, opening, read]), y

    blocks, nothing = np.arange(3 * FEATURES).reshape(3, -1), np.arange(0)
    (X, y), (asked, told) = sweeps(0.0), sweeps(0.05)
    known = fitted(X, y, blocks[1], blocks[2], spread=2)
    without = fitted(X[:, : 2 * FEATURES], y, blocks[1], nothing, spread=2)
    right = (known(asked).argmax(axis=1) == told).mean()
    others = without(asked[:, : 2 * FEATURES]).argmax(axis=1)
    assert right > (others == told).mean() + 0.015


@pytest.mark.parametrize(
    ("quantities", "curve", "absolute"),
    [
        ("dlnZ,dphase,lnZ0,phase0,lnZ,phase", (2, 3), (4, 5)),
        ("lnZ,dphase,phase0,lnZ0,dlnZ,phase", (2, 3), (5, 0)),
        ("dphase,dlnZ,lnZ0,phase0", (3, 2), ()),
        ("dlnZ,dphase,lnZ,phase", (), ()),
        ("dlnZ,lnZ0,phase0", (1, 2), ()),
    ],
)
def test_features_of_one_reading_are_paired_in_whatever_order_they_are_asked(
    quantities, curve, absolute
):
    names = tuple(quantities.split(","))
    problem = LocalizationProblem("column", len(names), names, ("left",), (1e3,), "")
    found = [tuple(each.tolist()) for each in curve_and_absolute(problem)]
    assert found == [curve, absolute]
