"""Localizers of interfaces that are read at frequencies of their own."""

import numpy as np
import pytest
from rcskin.localization.inputs.features import features
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError, check


@pytest.fixture(scope="module")
def thinned(sheet):
    """A function that leaves out the readings of a sheet that a mask leaves out."""

    def thin(taken):
        part = sheet.where(np.broadcast_to(taken, sheet["Rs"].shape))
        told = part.assign_coords(taken=(("interface", "frequency"), taken.astype(np.int8)))
        return check(told.assign_coords({name: sheet[name] for name in ("row", "column")}))

    return thin


@pytest.fixture(scope="module")
def taken(sheet):
    taken = np.ones((sheet.sizes["interface"], sheet.sizes["frequency"]), dtype=bool)
    taken[0, 0] = taken[-1, -1] = False
    return taken


@pytest.mark.parametrize("quantities", [("Rs", "Cp"), ("lnZ", "phase")])
def test_features_are_those_of_what_was_read(sheet, thinned, taken, quantities):
    whole = features(sheet, quantities).reshape(-1, 2, *taken.shape)
    found = features(thinned(taken), quantities)
    np.testing.assert_array_equal(found, whole[:, :, taken].reshape(len(whole), -1))


@pytest.mark.parametrize("estimator", ["ksvm-ovo", "gaussian"])
def test_a_model_of_them_is_kept_and_takes_no_others(sheet, thinned, taken, estimator, tmp_path):
    sweeps = thinned(taken)
    model = train(sweeps, "column", estimator, quantities="Rs,Cp")
    save(tmp_path / "own.npz", model)
    again = load(tmp_path / "own.npz")
    assert again.problem == model.problem and again.problem.taken
    np.testing.assert_array_equal(again.predict(sweeps), model.predict(sweeps))
    for other in (sheet, thinned(np.roll(taken, 1, axis=1))):
        with pytest.raises(InputError, match="read at other `frequencies` of their own"):
            again.predict(other)


def test_a_model_without_takes_none(sheet, thinned, taken):
    model = train(sheet, "column", "ksvm-ovo")
    assert model.problem.taken == ()
    with pytest.raises(InputError, match="read at other `frequencies` of their own"):
        model.predict(thinned(taken))
