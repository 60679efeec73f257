"""Sweeps of a strip in closed form, whose scene the simulator knows; and what is found of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from rcskin.localization.gap.comparison import prepare_comparison
from rcskin.localization.gap.gap_findings import find_gap
from rcskin.localization.gap.options import GapOptions
from rcskin.localization.gap.pair import pair_sweeps
from rcskin.simulator.progress import silent
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import UNPRESSED, InputError, build, impedance

FREQUENCY = np.geomspace(1e3, 200e3, 8)
COLUMNS = 3


@dataclass(frozen=True)
class Skin:
    """A strip of COLUMNS pixels: total resistance [ohm] and capacitance [F]; the meter's noise."""

    resistance: float = 100e3
    capacitance: float = 70e-12
    noise: float = 0.003

    @cached_property
    def text(self):
        """TOML of its scene, with sheets of half the resistance each."""
        strip = load_scene("strip-1x3")
        length, width = strip.skin.sides
        noise = dict.fromkeys(("magnitude_noise", "phase_noise"), self.noise)
        changed = {
            "skin.sheet_resistance": self.resistance * width / length / 2,
            "skin.foam.capacitance_per_area": self.capacitance / (length * width),
            "sweep.frequencies": FREQUENCY.tolist(),
            "readout": noise,
        }
        return scene_text(strip.with_(changed))

    def impedance(self, pixel, factor, frequency, interface):
        """Z of a chain of uniform segments, one pressed, open at the end, fed at the interface."""
        C = np.full(COLUMNS, self.capacitance / COLUMNS)
        if pixel:
            C[pixel - 1] *= factor
        s, R, Y = 2j * np.pi * frequency, self.resistance / COLUMNS, 0.0
        for segment in C if interface == "right" else C[::-1]:
            Zc, tanh = np.sqrt(R / (s * segment)), np.tanh(np.sqrt(s * R * segment))
            Y = (Y + tanh / Zc) / (1 + Y * Zc * tanh)
        return 1 / Y


def exact(skin, presses, session, interfaces, frequency):
    """Sweeps of presses (row, column, factor), free of noise."""
    Z = [[skin.impedance(j, f, frequency, name) for name in interfaces] for _, j, f in presses]
    return build(
        np.array(Z),
        frequency,
        interface=interfaces,
        press=[f"{i},{j}:{f}" if i else UNPRESSED for i, j, f in presses],
        row=[i for i, _, _ in presses],
        column=[j for _, j, _ in presses],
        session=session,
        errors={name: np.zeros(np.shape(Z)) for name in ("Rs_error", "Cp_error")},
        attributes={"scene": skin.text, "rtol": 1e-9},
    ).dataset()


def seen_by_meter(sweeps, noise, seed):
    """With the meter's noise on |Z| and phase."""
    Z = impedance(sweeps)
    gain, turn = noise * np.random.default_rng(seed).standard_normal((2, *Z.shape))
    return build(
        Z * (1 + gain) * np.exp(1j * turn),
        sweeps["frequency"].values,
        interface=list(sweeps["interface"].values),
        **{name: list(sweeps[name].values) for name in ("press", "row", "column", "session")},
        attributes={**sweeps.attrs, "readout": f"{noise}"},
    ).dataset()


@pytest.fixture(scope="session")
def make_skin_sweeps():
    """A function that makes sweeps of a skin, every pixel pressed several times.

    Pixels of one column look alike; the scene has one row.
    """

    def make(
        repetitions=3,
        *,
        rows=1,
        seed=0,
        sessions=1,
        rest=True,
        noisy=True,
        interfaces=("left",),
        frequency=FREQUENCY,
        attributes=None,
        **skin,
    ):
        random = np.random.default_rng(seed)
        pixels = [(0, 0)] * rest + [
            (i, j) for i in range(1, rows + 1) for j in range(1, COLUMNS + 1)
        ]
        presses = [
            (i, j, float(2 + 0.1 * random.standard_normal()) if i else 1.0)
            for i, j in pixels * (repetitions * sessions)
        ]
        session = np.repeat(np.arange(sessions), len(pixels) * repetitions)
        found = exact(Skin(**skin), presses, session, list(interfaces), np.asarray(frequency))
        if noisy:
            found = seen_by_meter(found, Skin(**skin).noise, [seed, 1])
        return found if attributes is None else found.drop_attrs().assign_attrs(attributes)

    return make


@pytest.fixture
def uncalibrated(monkeypatch):
    """Neither a calibration nor causes, which take most of the time."""

    def refuse(*given, **more):
        raise InputError("left out")

    monkeypatch.setattr("rcskin.simulator.calibration.run.calibrate", refuse)
    monkeypatch.setattr("rcskin.simulator.calibration.misfit.gap_by_parameter", refuse)


ADDABLE = "rcskin.simulator.calibration.misfit.addable_effects"


@pytest.fixture(autouse=True)
def nothing_tried(monkeypatch):
    """What surrounds a skin is tried in the tests of calibrations: its training takes seconds."""
    monkeypatch.setattr(ADDABLE, lambda scene: [])


@pytest.fixture(scope="session")
def make_findings():
    """A function that asks everything of a pair."""

    def make(simulated, other, target="column", touches=2, estimator="ksvm-ovo"):
        question = GapOptions(target, estimator, seed=0, draws=2, calibration_touches=touches)
        pair = pair_sweeps(simulated, other, scene=None, seed=0)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(ADDABLE, lambda scene: [])
            return find_gap(prepare_comparison(pair, question), silent)

    return make


@pytest.fixture(scope="session")
def pair_of_sweeps(make_skin_sweeps):
    """Simulated sweeps, and a twin of 20 % more resistance."""
    simulated = make_skin_sweeps(6)
    told = {"model": "measured", "twin": "20 % more resistance", "scene": Skin().text}
    return simulated, make_skin_sweeps(12, seed=1, resistance=120e3, attributes=told)


@pytest.fixture(scope="session")
def findings(pair_of_sweeps, make_findings):
    """What is found of that pair."""
    return make_findings(*pair_of_sweeps)
