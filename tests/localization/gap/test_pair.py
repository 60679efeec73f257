"""Both sides made comparable, and what each is called."""

import numpy as np
import pytest
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
from rcskin.simulator.scene.scene_files import parse_scene
from rcskin.simulator.sweeps import InputError

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
