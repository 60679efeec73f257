"""Files of reduced models: what they hold, and those that are refused."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.models.reduced import model_file
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.terminals import read, trained
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from rcskin.tests.spoiling import share_refused


@pytest.fixture(scope="module")
def model():
    return reduce(load_scene("strip-1x3").parts, 1e-2)


def test_a_flipped_bit_is_refused_or_changes_no_number(model, tmp_path):
    path = tmp_path / "model.npz"
    save(model, path)

    def same(again):
        return np.array_equal(again.stiffness, model.stiffness)

    assert share_refused(path, load, same, 60) > 5 / 6


def test_a_model_that_is_read_otherwise_is_so_in_its_file(tmp_path):
    """At its own frequencies, which are not those of its scene either."""
    scene, band = load_scene("strip-1x3"), np.array([1e3, 3e4])
    (own,) = scene.interfaces
    turned = own.model_copy(update={"high": own.low, "low": own.high})
    model = read(trained(scene.parts, 1e-2, frequency=band), [turned])
    save(model, tmp_path / "model.npz")
    again = load(tmp_path / "model.npz")
    assert (
        again.circuit.excitations
        == model.circuit.excitations
        != two_fields(scene.parts.skin, scene.parts.setup).excitations
    )
    np.testing.assert_array_equal(again.frequency, band)


def test_a_model_of_an_earlier_layout_must_be_trained_again(model, tmp_path, monkeypatch):
    monkeypatch.setattr(model_file, "LAYOUT", model_file.LAYOUT - 1)
    save(model, tmp_path / "model.npz")
    monkeypatch.undo()
    with pytest.raises(InputError, match=r"model\.npz: .* layout is 1, .* train again"):
        load(tmp_path / "model.npz")


@pytest.mark.parametrize(
    "name", ["frequency", "terminal_field", "conductance", "basis", "stiffness", "factors"]
)
def test_arrays_that_do_not_fit_are_refused(model, tmp_path, name):
    array = getattr(model, name)
    spoilt = [
        array[..., :-1] if name != "frequency" else array[None],
        array - 10**6 if name == "terminal_field" else array * np.nan,
    ]
    for each in spoilt:
        save(replace(model, **{name: each}), tmp_path / "model.npz")
        with pytest.raises(InputError, match=r"model\.npz: not a reduced model: `"):
            load(tmp_path / "model.npz")
