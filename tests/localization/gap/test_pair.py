"""Both sides made comparable, and what each is called.

Distances of mean sweeps, and the units they are counted in. What is tested was never added to
training, nor used to calibrate. Accuracies across and within a side. The gap of a yarn that is
read by gains, with phase or by magnitude alone.
"""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.localization.gap.distance import distances, meter_error, neighbours
from rcskin.localization.gap.mean_accuracy import (
    PairedSamples,
    Split,
    cross_validated,
    feature_sets,
    largest_k,
    paired_samples,
    reserved_for_calibration,
    touch_splits,
    transfer_accuracy,
)
from rcskin.localization.gap.pair import (
    MAX_SWEEPS,
    MEASUREMENT,
    SECOND,
    SESSION_EXCESS,
    TWIN,
    check_simulated,
    label_of_side,
    pair_sweeps,
    pixel_of,
)
from rcskin.localization.inputs.features import available_features
from rcskin.localization.inputs.samples import LocalizationProblem
from rcskin.localization.inversion.estimators import chosen
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import ReadingError, simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import load_scene, parse_scene
from rcskin.simulator.sweeps import InputError, build, impedance, write

MEASURED = {"model": "measured"}


@pytest.mark.parametrize(
    ("attributes", "noun"),
    [
        ({}, MEASUREMENT),
        (MEASURED, MEASUREMENT),
        (MEASURED | {"meter": "HIOKI,IM3523,180912345,V1.00"}, MEASUREMENT),
        (MEASURED | {"meter": "HIOKI,IM3523,000000000,V1.00"}, TWIN),
        ({"model": "virtual meter"}, TWIN),
        (MEASURED | {"twin": "seed 3"}, TWIN),
        (MEASURED | {"twin": 0}, TWIN),
        ({"model": "exact line", "rtol": 1e-4}, SECOND),
        ({"twin": 1, "rtol": 1e-4}, TWIN),
    ],
)
def test_the_noun_is_taken_from_the_attributes(make_skin_sweeps, attributes, noun):
    assert label_of_side(make_skin_sweeps(1, attributes=attributes)) == noun


def test_measured_sweeps_cannot_stand_for_simulated_ones(make_skin_sweeps):
    for model, told in (("measured", "measured"), ("virtual meter", "twin")):
        with pytest.raises(InputError, match=f"run.nc: contains {told} sweeps"):
            check_simulated(make_skin_sweeps(1, attributes={"model": model}), "run.nc")


def test_only_interfaces_of_both_are_kept_and_the_others_reported(make_skin_sweeps):
    both, left = make_skin_sweeps(interfaces=("left", "right")), make_skin_sweeps()
    for first, second in ((both, left), (left, both)):
        pair = pair_sweeps(first, second, None, 0)
        assert list(pair.simulated["interface"]) == list(pair.other["interface"]) == ["left"]
        assert pair.notes == ["Interfaces that only one side has are left out: right."]


def test_other_frequencies_are_simulated_anew(make_skin_sweeps):
    f = np.geomspace(2e3, 1e5, 5)
    pair = pair_sweeps(make_skin_sweeps(), make_skin_sweeps(frequency=f), None, 0)
    np.testing.assert_array_equal(pair.simulated["frequency"], f)
    assert pair.noise_free
    assert "simulated again" in pair.notes[0]
    named = make_skin_sweeps().drop_attrs()
    scene = parse_scene(make_skin_sweeps().attrs["scene"], "named")
    assert pair_sweeps(named, make_skin_sweeps(frequency=f), scene, 0).scene == scene


def test_presses_of_no_single_pixel_are_left_out(make_skin_sweeps):
    sweeps = make_skin_sweeps(2, attributes=MEASURED)
    row = sweeps["row"].values.copy()
    row[[3, 4]] = -1
    other = sweeps.assign_coords(row=("sweep", row), column=("sweep", np.where(row < 0, -1, 1)))
    pair = pair_sweeps(make_skin_sweeps(), other, None, 0)
    assert pair.other.sizes["sweep"] == sweeps.sizes["sweep"] - 2
    assert pair.notes == ["2 measured sweeps of no single pixel are left out."]


@pytest.mark.parametrize("sessions", [1, 3, 400])
def test_many_simulated_sweeps_are_thinned_and_keep_the_skin_at_rest(make_skin_sweeps, sessions):
    sweeps = make_skin_sweeps(1)
    number = np.arange(MAX_SWEEPS * SESSION_EXCESS * 2)
    many = sweeps.isel(sweep=number % sweeps.sizes["sweep"])
    many = many.assign_coords(session=("sweep", number * sessions // number.size))
    pair = pair_sweeps(many, sweeps, None, 0)
    assert pair.simulated.sizes["sweep"] == MAX_SWEEPS
    assert pair.notes == [
        f"{MAX_SWEEPS} of {number.size} simulated sweeps are used, drawn at random."
    ]
    assert available_features(pair.simulated, ["dlnZ"])[1].size > MAX_SWEEPS / 3
    again = pair_sweeps(many, sweeps, None, 0).simulated
    np.testing.assert_array_equal(again["session"], pair.simulated["session"])


def test_sweeps_that_no_meter_has_read_are_known(make_skin_sweeps):
    for noisy in (True, False):
        pair = pair_sweeps(make_skin_sweeps(noisy=noisy), make_skin_sweeps(), None, 0)
        assert pair.noise_free is not noisy


def test_pixels_have_numbers_and_rest_is_zero(make_skin_sweeps):
    assert pixel_of(make_skin_sweeps(1, rows=2)).tolist() == [
        0,
        10001,
        10002,
        10003,
        20001,
        20002,
        20003,
    ]


def test_an_interface_without_a_name_is_the_only_one_of_the_other_side(make_skin_sweeps):
    sweeps = make_skin_sweeps()
    pair = pair_sweeps(sweeps, sweeps.assign_coords(interface=["unnamed"]), None, 0)
    assert list(pair.other["interface"].values) == ["left"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequency": np.array([1e3, 2e3])}, "8 frequencies of 1000 to 200000 Hz, the others 2"),
        ({"interfaces": ("right",)}, "no interface in common: left and right"),
    ],
)
def test_sides_that_share_nothing_are_refused(make_skin_sweeps, change, message):
    with pytest.raises(InputError, match=message):
        pair_sweeps(make_skin_sweeps().drop_attrs(), make_skin_sweeps(**change), None, 0)


def test_sides_without_a_common_pixel_are_refused(make_skin_sweeps):
    sweeps = make_skin_sweeps(rows=2)
    row = sweeps["row"].values
    for kept in (row == 0, row == 2):
        with pytest.raises(InputError, match="no pixel is pressed in both"):
            pair_sweeps(sweeps.isel(sweep=row == 1), sweeps.isel(sweep=kept), None, 0)


NOISE = ReadingError(0.003, 0.002)


def shifted(sweeps, ohm):
    """The same sweeps with a series resistance."""
    return build(
        impedance(sweeps) + ohm,
        sweeps["frequency"].values,
        interface=list(sweeps["interface"].values),
        **{name: list(sweeps[name].values) for name in ("press", "row", "column", "session")},
        attributes=sweeps.attrs,
    ).dataset()


@pytest.fixture(scope="module")
def quiet(make_skin_sweeps):
    return make_skin_sweeps(2, rows=2, noisy=False, interfaces=("left", "right"))


@pytest.mark.parametrize("pressed", [True, False])
def test_a_resistance_in_series_is_the_distance_of_rs_at_every_frequency(quiet, pressed):
    found = distances(quiet, shifted(quiet, 250.0), None, "column", pressed)["Rs"]
    assert found.mean.shape == (2, 8)
    np.testing.assert_allclose(found.mean, 250.0, rtol=1e-6)
    np.testing.assert_allclose(found.rms, 250.0, rtol=1e-6)
    np.testing.assert_allclose(found.percent, 100 * 250.0 / found.simulated)
    assert found.meter_errors is None


def test_each_pixel_counts_once_however_often_it_was_pressed(quiet):
    of_one = np.flatnonzero((quiet["row"].values == 1) & (quiet["column"].values == 1))
    again = quiet.isel(sweep=[*range(quiet.sizes["sweep"]), *of_one, *of_one])
    found = distances(quiet, again, None, "column", pressed=True)
    for distance in found.values():
        np.testing.assert_allclose(distance.mean, 0, atol=1e-12 * distance.simulated.max())


def test_the_meters_error_of_rs_and_cp_is_the_spread_of_its_readings(quiet):
    """Against many readings with the noise that a meter puts on |Z| and phase."""
    error = meter_error(quiet, NOISE)
    found = distances(quiet, quiet, error, "column", pressed=False)
    Z, f = impedance(quiet)[0], quiet["frequency"].values
    gain, turn = np.random.default_rng(0).standard_normal((2, 20_000, *Z.shape))
    read = Z * (1 + NOISE.magnitude * gain) * np.exp(1j * NOISE.phase * turn)
    np.testing.assert_allclose(found["Rs"].meter_error, read.real.std(axis=0), rtol=0.03)
    capacitance = (1 / read).imag / (2 * np.pi * f)
    np.testing.assert_allclose(found["Cp"].meter_error, capacitance.std(axis=0), rtol=0.03)


def test_a_separation_is_the_distance_of_neighbouring_columns(quiet):
    found = distances(quiet, quiet, None, "column", pressed=True)["Cp"]
    Cp, column = quiet["Cp"].values, quiet["column"].values
    one, two, three = (Cp[column == j].mean(axis=0) for j in (1, 2, 3))
    expected = np.sqrt(((one - two) ** 2 + (two - three) ** 2) / 2)
    np.testing.assert_allclose(found.separation, expected)


def test_rows_that_cannot_be_distinguished_have_no_unit_of_separation(quiet):
    strip = quiet.isel(sweep=quiet["row"].values < 2)
    assert np.isnan(distances(strip, strip, None, "row", pressed=True)["Rs"].separations).all()


def test_where_classes_lie_together_but_for_rounding_they_are_no_unit(quiet):
    """As Cp at low frequency, which is the same whatever is pressed."""
    found = distances(quiet, shifted(quiet, 1e3), None, "column", pressed=True)["Rs"]
    apart = found.separation.copy()
    apart[:, 0] = 1e-9 * apart.max()
    told = replace(found, separation=apart).separations
    assert np.isnan(told[:, 0]).all() and np.isfinite(told[:, 1:]).all()


def test_neighbours_share_a_side_and_the_skin_at_rest_has_none():
    assert neighbours(np.array([0, 1, 2, 4])) == [(1, 2)]
    pixels = np.array(["0,0", "1,1", "1,2", "2,2", "3,1"])
    assert neighbours(pixels) == [("1,1", "1,2"), ("1,2", "2,2")]


def test_presses_that_only_one_side_has_do_not_count(quiet):
    unpressed = quiet.isel(sweep=quiet["row"].values == 0)
    assert distances(quiet, unpressed, None, "column", pressed=True) is None
    left = quiet.isel(sweep=quiet["column"].values != 3)
    assert distances(left, quiet, None, "column", True)["Rs"].mean == pytest.approx(0, abs=1e-6)


def test_without_a_scene_the_noise_is_estimated_from_repeats(make_skin_sweeps):
    sweeps = make_skin_sweeps(30, frequency=np.geomspace(1e3, 2e5, 30), noise=0.004)
    error = meter_error(sweeps, None)
    assert "repeatability" in error.source
    np.testing.assert_allclose(error.magnitude, 0.004, rtol=0.2)


@pytest.mark.parametrize("chosen", [{"sweep": [0, 1]}, {"frequency": [0, 1]}])
def test_neither_stated_nor_repeated_the_error_is_unknown(make_skin_sweeps, chosen):
    assert meter_error(make_skin_sweeps().isel(chosen), None) is None


def test_the_scene_goes_before_repeats(make_skin_sweeps):
    error = meter_error(make_skin_sweeps(), NOISE)
    assert error.source == "the scene's [readout]"
    assert set(error.magnitude) == {0.003} and set(error.phase) == {0.002}


def grid(rows, columns, repetitions, rest=0):
    """Rows, columns and numbers of pixels, each pressed several times."""
    pixels = [(0, 0)] * rest + [(i, j) for i in range(1, rows + 1) for j in range(1, columns + 1)]
    pixels = [(0, 0)] * rest + pixels[rest:] * repetitions
    row, column = np.array(pixels).T
    return row, column, np.where(row > 0, 10_000 * row + column, 0)


@given(
    st.lists(st.integers(0, 5), min_size=4, max_size=60),
    st.integers(0, 6),
    st.integers(0, 2**16),
    st.data(),
)
def test_no_split_leaks(pixels, k, seed, data):
    pixel = np.array(pixels)
    reserved = np.array(
        data.draw(st.lists(st.booleans(), min_size=len(pixel), max_size=len(pixel)))
    )
    splits = touch_splits(pixel, reserved, k, 3, seed)
    for added, tested in splits or []:
        assert not set(added) & set(tested)
        assert not reserved[tested].any()
        for each in set(pixel[tested]):
            assert np.sum(pixel[added] == each) == k
            first = np.flatnonzero((pixel == each) & reserved)[:k]
            assert set(first) <= set(added)
        assert set(pixel[added]) <= set(pixel[tested])


def test_every_sweep_that_is_neither_added_nor_reserved_is_tested():
    row, column, pixel = grid(2, 3, 4)
    reserved = reserved_for_calibration(row, column, 2, np.zeros(row.size))
    for k in (0, 1, 3):
        for added, tested in touch_splits(pixel, reserved, k, 4, 0):
            assert set(added) | set(tested) | set(np.flatnonzero(reserved)) == set(range(row.size))


def test_draws_differ_and_come_again_with_the_seed():
    row, column, pixel = grid(2, 3, 5)
    none = np.zeros(row.size, dtype=bool)
    first, again, other = (touch_splits(pixel, none, 2, 3, seed) for seed in (1, 1, 2))
    added = [[split.added.tolist() for split in splits] for splits in (first, again, other)]
    assert added[0] == added[1] != added[2]
    assert len({tuple(each) for each in added[0]}) == 3
    assert len(touch_splits(pixel, none, 0, 3, 1)) == 1


def test_a_pixel_without_one_to_spare_leaves_no_split():
    row, column, pixel = grid(1, 3, 3)
    none = np.zeros(row.size, dtype=bool)
    assert touch_splits(pixel, none, 2, 1, 0) is not None
    assert touch_splits(pixel, none, 3, 1, 0) is None
    assert largest_k(pixel, none) == 2
    assert touch_splits(pixel, ~none, 0, 1, 0) is None


def test_half_of_the_rest_of_each_session_and_pixels_far_apart_calibrate():
    row = np.array([0, 0, 0, 0, 0, *[1, 1, 1, 3, 3, 3] * 2])
    column = np.array([0, 0, 0, 0, 0, *[1, 2, 3, 1, 2, 3] * 2])
    session = np.array([1, 1, 1, 2, 2, *[1] * 6, *[2] * 6])
    reserved = reserved_for_calibration(row, column, 2, session)
    assert reserved[:5].tolist() == [True, True, False, True, False]
    chosen = [(row[k], column[k]) for k in np.flatnonzero(reserved) if row[k]]
    assert chosen == [(1, 1), (3, 3)]


@pytest.mark.parametrize(("touches", "pressed"), [(0, 0), (4, 4), (99, 6)])
def test_as_many_pixels_calibrate_as_asked_and_there_are(touches, pressed):
    row, column, _ = grid(2, 3, 2)
    assert reserved_for_calibration(row, column, touches, np.zeros(12)).sum() == pressed


def test_fewer_than_no_touches_are_refused():
    with pytest.raises(InputError, match="must be >= 0, got -1"):
        reserved_for_calibration(*grid(1, 2, 2)[:2], -1, np.zeros(4))


KSVM = chosen("ksvm-ovo", "column")


def points(places, classes, repetitions=4):
    """Samples that lie in a tight heap for each class."""
    random = np.random.default_rng(0)
    problem = LocalizationProblem("column", 1, ("Rs",), ("left",), (1e3,), "")
    X = np.repeat(np.array(places, dtype=float), repetitions)[:, None]
    y = np.repeat(classes, repetitions)
    return PairedSamples(problem, X + 1e-3 * random.standard_normal(X.shape), y, y)


def indices(*which):
    return np.array(which, dtype=np.intp)


def test_a_shift_of_one_class_is_undone_by_what_is_added():
    """The other side's class 1 lies where the simulation has class 2."""
    simulated, other = points([0, 1, 2], [1, 2, 3]), points([1, 2, 3], [1, 2, 3])
    everything = Split(indices(), np.arange(12))
    alone = transfer_accuracy(simulated, other, [everything], KSVM)
    assert alone.confusion.counts[0].tolist() == [0, 4, 0]
    same = transfer_accuracy(simulated, simulated, [everything], KSVM)
    assert (same.mean, same.spread, same.draws) == (1.0, 0.0, 1)


def test_draws_are_reported_by_their_mean_and_spread_and_counted_together():
    simulated, other = points([0, 1], [1, 2]), points([0, 0], [1, 2])
    splits = [Split(indices(), indices(0, 1, 2, 4)), Split(indices(), indices(0, 4, 5, 6))]
    found = transfer_accuracy(simulated, other, splits, KSVM)
    assert (found.mean, found.spread) == (0.5, pytest.approx(0.5 * np.sqrt(0.5)))
    assert found.confusion.labels == (1, 2)
    assert found.confusion.counts.tolist() == [[4, 0], [4, 0]]


@pytest.mark.parametrize(
    ("sessions", "rows", "target", "grouping"),
    [
        (2, (0, 1, 2), "column", "session"),
        (1, (0, 1, 2), "column", "press"),
        (1, (0, 1), "column", None),
        (1, (0, 1, 2), "pixel", None),
    ],
)
def test_the_hardest_grouping_that_can_be_is_taken(
    make_skin_sweeps, sessions, rows, target, grouping
):
    sweeps = make_skin_sweeps(rows=2, sessions=sessions)
    sweeps = sweeps.isel(sweep=np.isin(sweeps["row"].values, rows))
    samples = paired_samples(sweeps, feature_sets(sweeps)["absolute"], target)
    found = cross_validated(sweeps, samples, KSVM, 0)
    assert found.grouping == grouping
    assert found.accuracy.confusion.total == sweeps.sizes["sweep"]
    assert cross_validated(sweeps, samples, KSVM, 0, grouped=False).grouping is None


def test_a_class_of_one_sweep_cannot_be_cross_validated(make_skin_sweeps):
    sweeps = make_skin_sweeps(1)
    samples = paired_samples(sweeps, feature_sets(sweeps)["absolute"], "pixel")
    assert cross_validated(sweeps, samples, KSVM, 0) is None


FREQUENCIES = {"start": 2e3, "stop": 25e3, "points": 6, "spacing": "linear"}


def yarn(magnitude_only, sheet_resistance=13.889e3):
    return load_scene("knit-36").with_(
        {
            "pixels.columns": 4,
            "sweep.frequencies": FREQUENCIES,
            "experiment.repetitions": 3,
            "interface.1.magnitude_only": magnitude_only,
            "interface.2.magnitude_only": magnitude_only,
            "skin.top.sheet_resistance": sheet_resistance,
            "press.factor_spread": 0.0,
        }
    )


def simulated(magnitude_only):
    scene = yarn(magnitude_only)
    return simulate(Solver(scene.parts), every_press(scene.parts.skin, scene.press))


def recorded(magnitude_only):
    """Sweeps of a yarn with a tenth more of resistance, as its reader reads them."""
    scene = yarn(magnitude_only, 1.1 * 13.889e3)
    presses = planned_presses(scene.parts.skin, scene.parts.plan, np.random.default_rng(1))
    return read_out(simulate(Solver(scene.parts), presses), scene.readout, np.random.default_rng(2))


@pytest.mark.usefixtures("linear_intervals", "unpainted")
@pytest.mark.parametrize("magnitude_only", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_the_resistance_of_a_yarn_is_named_as_the_cause(run, tmp_path, magnitude_only):
    write(simulated(magnitude_only), tmp_path / "simulated.nc")
    write(recorded(magnitude_only), tmp_path / "recorded.nc")
    files = tmp_path / "simulated.nc", tmp_path / "recorded.nc"
    asked = ("--target", "column", "--draws", 1, "-o", tmp_path / "gap")
    code, out, _ = run("gap", *files, *asked)
    assert code == 0 and "Sheet resistance explains most of the gap" in out
    found = json.loads((tmp_path / "gap" / "gap.json").read_text())
    phase = [] if magnitude_only else ["phaseG"]
    assert found["features"]["gains"] == ["lnG", *phase]
    before, after = (found["distance"][stage]["pressed"] for stage in ("before", "after"))
    assert list(before) == ["gain", *([] if magnitude_only else ["gain_phase"])]
    for name in before:
        far, near = (np.abs(each[name]["mean"]).max() for each in (before, after))
        assert near < 0.2 * far


def test_gains_are_not_compared_with_magnitudes(refused, tmp_path):
    write(simulated(True), tmp_path / "magnitudes.nc")
    write(simulated(False), tmp_path / "gains.nc")
    files = tmp_path / "magnitudes.nc", tmp_path / "gains.nc"
    message = "the simulated sweeps hold the magnitude of the gain, the others the gain; "
    assert message in refused("gap", *files, "-o", tmp_path / "gap")
