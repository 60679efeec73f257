"""

Features of gains, and models of one kind of readings that are given another.
"""

import numpy as np
import pytest
from rcskin.localization.evaluation.evaluation import score
from rcskin.localization.inputs.features import chosen_quantities, features
from rcskin.localization.inputs.targets import labels
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError, build
from rcskin.simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE


def test_features_lie_quantity_by_quantity_then_interface_then_frequency(sheet):
    X = features(sheet, ("Cp", "X"))
    assert X.shape == (sheet.sizes["sweep"], 2 * 2 * 20)
    np.testing.assert_array_equal(X[:, :20], sheet["Cp"].sel(interface="left"))
    np.testing.assert_array_equal(X[:, 20:40], sheet["Cp"].sel(interface="right"))
    np.testing.assert_array_equal(X[:, 60:], sheet["X"].sel(interface="right"))


def test_the_order_of_dimensions_in_the_data_set_does_not_matter(sheet):
    turned = sheet.transpose("frequency", "sweep", "interface")
    np.testing.assert_array_equal(features(turned), features(sheet))


@pytest.mark.parametrize("quantities", [("Rs", "Cs"), (), ("Rs", "Rs")])
def test_quantities_that_are_no_features_are_refused(strip, quantities):
    with pytest.raises(InputError, match="`quantities` must"):
        features(strip, quantities)


def test_labels_give_column_row_and_pixel(make_sweeps):
    sweeps = make_sweeps(2, 2, repetitions=1)
    assert labels(sweeps, "column").tolist() == [0, 1, 2, 1, 2]
    assert labels(sweeps, "row").tolist() == [0, 1, 1, 2, 2]
    assert labels(sweeps, "pixel").tolist() == ["0,0", "1,1", "1,2", "2,1", "2,2"]


def test_a_press_of_no_single_pixel_has_no_label(strip):
    touched = strip.assign_coords(
        row=strip["row"].where(strip["press"] != "1,3:2.0", -1),
        column=strip["column"].where(strip["press"] != "1,3:2.0", -1),
    )
    with pytest.raises(InputError, match="sweep 3: its press '1,3:2.0' is not a single pixel"):
        labels(touched)


def test_an_unknown_target_is_refused_with_those_there_are(strip):
    with pytest.raises(
        InputError, match="must be one of column, row, pixel, touches, pair, got 'depth'"
    ):
        labels(strip, "depth")


FREQUENCIES = [1e3, 2e3, 4e3]


def sweeps(kind=GAIN, seed=1, count=60):
    """Sweeps of two columns, every third of the unpressed skin."""
    random = np.random.default_rng(seed)
    column = np.arange(count) % 3
    shift = 0.1 * column[:, None, None] * np.array([0.5, 1.0, 1.5j])
    noise = random.standard_normal((2, count, 1, 3)) * 1e-3
    reading = 0.5 * np.exp(-0.3j + shift + noise[0] + 1j * noise[1])
    return build(
        reading,
        FREQUENCIES,
        interface=["left"],
        press=["none" if not c else f"1,{c}:2.0" for c in column],
        row=np.minimum(column, 1),
        column=column,
        kind=kind,
    ).dataset()


def test_features_of_gains_are_logarithm_and_phase():
    found = features(sweeps(), "gain,lnG,phaseG")
    gain, logarithm, phase = np.split(found, 3, axis=1)
    np.testing.assert_allclose(np.log(gain), logarithm)
    np.testing.assert_allclose(phase, sweeps()["gain_phase"].values[:, 0])


def test_changes_of_gains_are_from_the_unpressed_skin():
    given = sweeps().isel(sweep=slice(0, 3))
    found = features(given.isel(sweep=[1, 2]), "dlnG,dphaseG", rest=given.isel(sweep=[0]))
    ratio = given["gain"].values[1:, 0] / given["gain"].values[0, 0]
    turn = given["gain_phase"].values[1:, 0] - given["gain_phase"].values[0, 0]
    np.testing.assert_allclose(found, np.hstack([np.log(ratio), turn]))


@pytest.mark.parametrize(
    ("kind", "with_baseline", "without"),
    [
        (GAIN, ("dlnG", "dphaseG"), ("lnG", "phaseG")),
        (MAGNITUDE, ("dlnG",), ("lnG",)),
        (IMPEDANCE, ("dlnZ", "dphase"), ("Rs", "Cp")),
    ],
)
def test_features_by_default(kind, with_baseline, without):
    given = sweeps(kind)
    assert chosen_quantities(None, given) == with_baseline
    assert chosen_quantities(None, given.isel(sweep=given["row"].values > 0)) == without


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        (GAIN, "Cp", "the feature Cp needs the impedance, and the sweeps hold the gain; choose of"),
        (MAGNITUDE, "phaseG", "phaseG needs the complex gain, and the sweeps hold the magnitude"),
        (IMPEDANCE, "lnG", "lnG needs the complex gain, and the sweeps hold the impedance"),
    ],
)
def test_a_feature_says_which_readings_it_needs(kind, name, message):
    with pytest.raises(InputError, match=message):
        features(sweeps(kind), name)


def accuracy(model, given):
    """Share of the columns that a model finds."""
    return score(model.learned, model.samples(given)).figures()["right of all"]


@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
def test_a_localizer_of_gains_finds_the_column(kind):
    model = train(sweeps(kind))
    assert accuracy(model, sweeps(kind, seed=2)) > 0.9


@pytest.mark.parametrize(
    ("trained", "given", "message"),
    [
        (IMPEDANCE, GAIN, "trained on the features dlnZ, dphase, and the sweeps hold the gain"),
        (GAIN, IMPEDANCE, "dlnG, dphaseG, and the sweeps hold the impedance, which has no dlnG"),
        (GAIN, MAGNITUDE, "the sweeps hold the magnitude of the gain, which has no dphaseG"),
    ],
)
def test_a_localizer_refuses_another_kind_of_readings(trained, given, message):
    model = train(sweeps(trained))
    with pytest.raises(InputError, match=message):
        model.predict(sweeps(given, seed=2))


def test_magnitudes_alone_serve_a_localizer_without_phases():
    model = train(sweeps(GAIN), quantities="dlnG")
    assert accuracy(model, sweeps(MAGNITUDE, seed=2)) > 0.9
