"""Sweeps of presses, and of none at all."""

import numpy as np
import pytest
from rcskin.simulator.measure.simulate import gather, read_by_meter, resimulated, simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, concatenate


@pytest.fixture(scope="module")
def scene():
    return load_scene("strip-1x3")


def none_of(scene):
    return simulate(Solver(scene.parts), [Press()]).isel(sweep=[])


@pytest.mark.parametrize(
    "simulated",
    [
        lambda scene: simulate(Solver(scene.parts), []),
        lambda scene: gather(Solver(scene.parts), iter([])),
        lambda scene: resimulated(none_of(scene), scene.parts, scene.frequencies),
    ],
)
def test_no_press_at_all_is_refused(scene, simulated):
    with pytest.raises(InputError, match="^`presses` must hold at least one press, got none$"):
        simulated(scene)


def test_no_sweeps_are_not_joined():
    with pytest.raises(InputError, match="^`parts` must hold at least one data set, got none$"):
        concatenate([])


def test_a_meter_reads_no_sweeps_as_none(scene):
    read = read_by_meter(none_of(scene), scene.parts.meter, 1)
    assert read.sizes["sweep"] == 0
    assert read["Rs"].shape == (0, *np.shape(none_of(scene)["Rs"])[1:])


def test_a_press_that_comes_again_reads_the_same(scene):
    presses = [parse_press(text, 2.0) for text in ("none", "1,2", "none", "1,2:3", "1,2")]
    found = simulate(Solver(scene.parts), presses)
    assert found["press"].values.tolist() == [str(press) for press in presses]
    for one, again in ((0, 2), (1, 4)):
        np.testing.assert_array_equal(found["Rs"][one], found["Rs"][again])
    assert (found["Rs"][1] != found["Rs"][3]).all()
