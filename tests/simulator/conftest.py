"""Sweeps that no simulator made, changed scenes, and the command line as its user meets it."""

import numpy as np
import pytest
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import build

FREQUENCY = np.array([1e3, 2e3, 1e4])
NOISE = {"magnitude_noise": 1e-3, "phase_noise": 2e-3}
ACCURACY = {"magnitude_accuracy": 3e-3, "phase_accuracy": 4e-3}


def made_sweeps(sweeps=2, interfaces=("left", "bottom"), frequency=FREQUENCY, Z=None, **more):
    """Sweeps of random impedance of an RC network's sign, labelled as presses of pixels."""
    rng = np.random.default_rng(1)
    shape = (sweeps, len(interfaces), len(frequency))
    Z = rng.uniform(1, 2, shape) - 1j * rng.uniform(1, 2, shape) if Z is None else Z
    labels = {
        "press": ["none", *(f"1,{j}:2.0" for j in range(1, sweeps))],
        "row": [0, *[1] * (sweeps - 1)],
        "column": [*range(sweeps)],
    }
    return build(Z, frequency, interface=interfaces, **{**labels, **more}).dataset()


@pytest.fixture(scope="session")
def make_sweeps():
    """A function that makes sweeps of any number of presses, interfaces and frequencies."""
    return made_sweeps


@pytest.fixture(scope="session")
def changed():
    """A function of a scene and of keys by dotted path."""
    return Scene.with_


@pytest.fixture(scope="session")
def noisy(make_scene):
    """A function that builds a scene with a readout and a spread of presses.

    accuracy: whether the meter errs alike in all readings of a session, too.
    """

    def build(
        *, readout=NOISE, accuracy=False, spread=0.1, factor=2.0, unpressed=False, **more
    ) -> Scene:
        scene = make_scene(factor=factor, **more)
        pressing = scene.press.model_copy(update={"factor_spread": spread})
        experiment = scene.experiment.model_copy(update={"unpressed": unpressed})
        changed = {
            "readout": Readout(**readout, **(ACCURACY if accuracy else {})),
            "press": pressing,
            "experiment": experiment,
        }
        return scene.model_copy(update=changed)

    return build


@pytest.fixture(scope="session")
def noisy_strip(noisy):
    """Four pixels in a row, read at nine frequencies by a meter that errs in every way."""
    return noisy(
        accuracy=True,
        length=0.1,
        width=0.02,
        columns=4,
        frequencies=np.geomspace(1e2, 1e5, 9).tolist(),
    )
