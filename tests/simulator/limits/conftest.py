"""Small scenes with a meter's noise."""

import pytest
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene import Scene

NOISE = {"magnitude_noise": 1e-3, "phase_noise": 2e-3}
ACCURACY = {"magnitude_accuracy": 3e-3, "phase_accuracy": 4e-3}


@pytest.fixture
def undrawn(monkeypatch):
    """Tables and summaries without their charts, which take half of the time."""
    for name in ("draw_maps", "draw_distances"):
        monkeypatch.setattr(f"rcskin.simulator.limits.figure.{name}", lambda *given: None)


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
