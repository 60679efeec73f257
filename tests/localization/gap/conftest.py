"""A toy skin in closed form, known by two numbers, as the report's `Simulation`; and its sweeps."""

import json
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from rcskin.localization.gap.findings import find
from rcskin.localization.gap.given import (
    Cause,
    Estimate,
    ReadingError,
    Recalibrated,
    Simulation,
    Style,
)
from rcskin.localization.gap.pair import paired
from rcskin.localization.gap.question import Question
from rcskin.localization.gap.trial import prepared
from rcskin.simulator.progress import silent
from rcskin.simulator.sweeps import UNPRESSED, build, impedance
from scipy.optimize import least_squares

FREQUENCY = np.geomspace(1e3, 200e3, 8)
COLUMNS = 3
FITTED = ("resistance", "capacitance")


@dataclass(frozen=True)
class Skin:
    """A line of COLUMNS pixels: total resistance [ohm] and capacitance [F]; the meter's noise."""

    resistance: float = 100e3
    capacitance: float = 70e-12
    noise: float = 0.003

    @property
    def text(self):
        return json.dumps(asdict(self))

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


def parsed(text):
    return Skin(**json.loads(text))


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
    )


def presses_of(sweeps):
    texts = [str(text) for text in sweeps["press"].values]
    factors = [float(text.split(":")[1]) if ":" in text else 1.0 for text in texts]
    return list(
        zip(sweeps["row"].values.tolist(), sweeps["column"].values.tolist(), factors, strict=True)
    )


def seen_by_meter(sweeps, text, seed):
    """With the meter's noise on |Z| and phase."""
    noise, Z = parsed(text).noise, impedance(sweeps)
    gain, turn = noise * np.random.default_rng(seed).standard_normal((2, *Z.shape))
    return build(
        Z * (1 + gain) * np.exp(1j * turn),
        sweeps["frequency"].values,
        interface=list(sweeps["interface"].values),
        **{name: list(sweeps[name].values) for name in ("press", "row", "column", "session")},
        attributes={**sweeps.attrs, "readout": f"{noise}"},
    )


def resimulated(sweeps, text, frequency):
    session, interfaces = sweeps["session"].values, list(sweeps["interface"].values)
    return exact(parsed(text), presses_of(sweeps), session, interfaces, np.asarray(frequency))


def fitted(skin, sweeps, names):
    """Factors on the named numbers that fit sweeps best, misfit before and after."""
    measured = np.log(impedance(sweeps))

    def off(logarithms):
        factors = dict(zip(names, np.exp(logarithms), strict=True))
        changed = replace(skin, **{name: getattr(skin, name) * factors[name] for name in names})
        again = resimulated(sweeps, changed.text, sweeps["frequency"].values)
        difference = np.log(impedance(again)) - measured
        return np.concatenate([difference.real.ravel(), difference.imag.ravel()])

    start = np.zeros(len(names))
    best = least_squares(off, start, max_nfev=8)
    before = float(np.sum(off(start) ** 2))
    return dict(zip(names, np.exp(best.x), strict=True)), before, 2 * float(best.cost)


def recalibrated(simulated, measured):
    skin = parsed(simulated.attrs["scene"])
    factors, _, _ = fitted(skin, measured, FITTED)
    new = replace(skin, **{name: getattr(skin, name) * factor for name, factor in factors.items()})
    again = resimulated(simulated, new.text, simulated["frequency"].values)
    estimates = [
        Estimate(name, unit, getattr(skin, name), value := getattr(new, name), value, value)
        for name, unit in zip(FITTED, ("ohm", "F"), strict=True)
    ]
    return Recalibrated(again, estimates)


def explained(text, measured):
    found = []
    for name in FITTED:
        _, before, after = fitted(parsed(text), measured, (name,))
        found.append(Cause(name, 1 - after / before))
    return sorted(found, key=lambda cause: -cause.share)


def reading_error(text):
    noise = parsed(text).noise
    return ReadingError(noise, noise) if noise else None


TOY = Simulation(
    scene=lambda name: Skin().text,
    reading_error=reading_error,
    resimulated=resimulated,
    read=seen_by_meter,
    recalibrated=recalibrated,
    explained=explained,
)


@pytest.fixture(scope="session")
def toy():
    """The toy skin's `Simulation`."""
    return TOY


@pytest.fixture(scope="session")
def make_skin_sweeps():
    """A function that makes sweeps of a toy skin of 2 rows, every pixel pressed several times."""

    def make(
        repetitions=3,
        *,
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
        pixels = [(0, 0)] * rest + [(i, j) for i in (1, 2) for j in range(1, COLUMNS + 1)]
        presses = [
            (i, j, float(2 + 0.1 * random.standard_normal()) if i else 1.0)
            for i, j in pixels * (repetitions * sessions)
        ]
        session = np.repeat(np.arange(sessions), len(pixels) * repetitions)
        found = exact(Skin(**skin), presses, session, list(interfaces), np.asarray(frequency))
        if noisy:
            found = seen_by_meter(found, Skin(**skin).text, [seed, 1])
        return found if attributes is None else found.drop_attrs().assign_attrs(attributes)

    return make


@pytest.fixture(scope="session")
def style():
    """Charts in matplotlib's own style."""

    @contextmanager
    def chart(path, width, height):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        figure.savefig(Path(path), dpi=40)

    return Style(
        chart, lambda axes: axes.set_xscale("log"), ("C0", "C1", "C2"), lambda name: f".{name}"
    )


@pytest.fixture(scope="session")
def make_findings():
    """A function that asks everything of a pair."""

    def make(simulated, other, target="column", touches=2, estimator="ksvm-ovo"):
        question = Question(target, estimator, seed=0, draws=2, touches=touches)
        pair = paired(simulated, other, TOY, scene="", seed=0)
        return find(prepared(pair, question, TOY), TOY, silent)

    return make


@pytest.fixture(scope="session")
def pair_of_sweeps(make_skin_sweeps):
    """Simulated sweeps, and a twin of 20 % more resistance."""
    simulated = make_skin_sweeps()
    told = {"model": "measured", "twin": "20 % more resistance", "scene": Skin().text}
    return simulated, make_skin_sweeps(6, seed=1, resistance=120e3, attributes=told)


@pytest.fixture(scope="session")
def findings(pair_of_sweeps, make_findings):
    """What is found of that pair."""
    return make_findings(*pair_of_sweeps)
