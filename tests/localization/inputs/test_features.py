import numpy as np
import pytest
from rcskin.localization.inputs.features import features
from rcskin.localization.inputs.targets import labels
from rcskin.simulator.sweeps import InputError


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
