"""Distances between classes in units of the meter's error, from first principles."""

import numpy as np
import pytest
from rcskin.localization.study.separation import (
    class_distances,
    in_units_of_error,
    label_of,
    separation,
)
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.sweeps import InputError

FREQUENCY = np.geomspace(1e3, 1e5, 8)
METER = Readout(magnitude_noise=0.01, phase_noise=0.002)


def random_impedance(presses):
    random = np.random.default_rng(1)
    phase = random.uniform(-1.5, -0.1, (presses, 1, len(FREQUENCY)))
    return random.uniform(1e3, 1e4, phase.shape) * np.exp(1j * phase)


def columns(*numbers):
    return [(number,) for number in numbers]


def test_a_known_pair_by_hand():
    """10 % of |Z| at one frequency is ln(1.1) / 0.01 = 9.53 errors, 10 mrad at the other 5."""
    Z = np.array([[[100, 50j]], [[110, 50j * np.exp(-0.01j)]]])
    readings = in_units_of_error(Z, METER, FREQUENCY)
    told = separation(readings, columns(1, 2), FREQUENCY[:2])
    assert told.least == pytest.approx(np.hypot(np.log(1.1) / 0.01, 5.0), rel=1e-9)
    assert told.median == told.least
    assert told.band_separation == pytest.approx(np.log(1.1) / 0.01)
    assert told.band_start == told.band_stop == FREQUENCY[0]


def test_half_the_noise_doubles_every_distance():
    Z, labels = random_impedance(6), columns(1, 1, 2, 2, 3, 3)
    halved = Readout(magnitude_noise=0.005, phase_noise=0.001)
    before, after = (
        separation(in_units_of_error(Z, r, FREQUENCY), labels, FREQUENCY) for r in (METER, halved)
    )
    for name in ("least", "median", "band_separation"):
        assert getattr(after, name) == pytest.approx(2 * getattr(before, name), rel=1e-12)
    assert (after.band_start, after.band_stop) == (before.band_start, before.band_stop)


def test_what_is_fixed_for_a_session_does_not_matter():
    Z, labels = random_impedance(4), columns(1, 2, 3, 4)
    session = 1.02 * np.exp(0.01j)
    plain, measured = (
        class_distances(in_units_of_error(which, METER, FREQUENCY), labels)
        for which in (Z, session * Z)
    )
    np.testing.assert_allclose(plain, measured, rtol=1e-9)


def test_classes_are_as_far_apart_as_their_nearest_presses():
    readings = np.array([0.0, 1.0, 5.0, 7.0, -4.0]).reshape(5, 1, 1)
    told = class_distances(readings, columns(1, 1, 2, 2, 0))
    np.testing.assert_allclose(told, [[0, 4, 9], [4, 0, 4], [9, 4, 0]])


def test_the_best_band_is_where_neighbours_part():
    readings = np.zeros((3, 8, 2))
    readings[0, 5:7], readings[2, 5:7] = -1, 1
    readings[1, 0], readings[2, 0] = 3, 3
    told = separation(readings, columns(1, 2, 3), FREQUENCY)
    assert (told.band_start, told.band_stop) == (FREQUENCY[5], FREQUENCY[6])
    assert told.band_separation == pytest.approx(2)


def test_the_skin_at_rest_is_no_neighbour_but_a_class():
    readings = np.array([0.0, 0.5, 4.0]).reshape(3, 1, 1)
    told = separation(readings, columns(0, 1, 2), FREQUENCY[:1])
    assert (told.least, told.band_separation) == (0.5, 3.5)


def test_a_class_is_a_column_a_row_or_a_pixel():
    assert [label_of((2, 3), target) for target in ("column", "row", "pixel")] == [
        (3,),
        (2,),
        (2, 3),
    ]


@pytest.mark.parametrize("name", ["magnitude_noise", "phase_noise"])
def test_a_meter_without_noise_is_refused(name):
    with pytest.raises(InputError, match=f"`readout.{name}` must be > 0"):
        in_units_of_error(random_impedance(1), METER.model_copy(update={name: 0.0}), FREQUENCY)
