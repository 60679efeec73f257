"""Questions whose answers are kept: sweeps, a calibration, limits and predictions.

A change of structure leaves the answers where they are; one that should move them makes them anew
and says why. Run: python tests/reference/questions.py writes answers.csv beside this file.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import rcskin

ANSWERS = Path(__file__).with_name("answers.csv")
FREQUENCIES = [1e3, 1e4, 1e5]
PRESSES = ("none", "1,1", "1,1:1.3+1,3:2.5")
EARTH = {"low": "virtual earth", "rim": False, "thickness": False}
FOAM = {
    "thickness": 4e-3,
    "mechanics": {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 1e5},
}
BODY = {"side": "bottom", "distance": 4e-3}
PRESSED = {"touches": [0.1, 0.9], "factor": {"low": 1.3, "high": 3.0}}
SKINS = {  # name: built-in scene, changes of it, relative tolerance, presses
    **{
        name: (name, {}, 1e-8, PRESSES)
        for name in ("sheet-3x3", "sheet-4x4", "sheet-5x5-crossed", "glove", "mug", "stretched")
    },
    **{name: (name, {}, 1e-8, PRESSES) for name in ("strip-1x3", "strip-1x4", "strip-1x5")},
    "two interfaces": ("sheet-5x5-two-interfaces", {}, 1e-8, ("none", "2,3")),
    "an L": ("l-shape", {}, 1e-6, ("none", "1,1")),
    "knit": ("knit-36", {}, 1e-8, ("none", "1,1")),
    "foam by depth": ("foam", {}, 1e-6, ("none", "1,1")),
    "unequal sheets": ("glove", {"skin.bottom.sheet_resistance": 9e3}, 1e-8, PRESSES),
    "lossy": ("glove", {"skin.foam.loss_tangent": 0.02}, 1e-8, PRESSES),
    "constant phase": ("glove", {"skin.foam.phase_exponent": 0.95}, 1e-8, PRESSES),
    "leaking": ("glove", {"skin.foam.leak": 50.0}, 1e-8, PRESSES),
    "anisotropic": ("glove", {"skin.top.anisotropy": {"ratio": 1.7, "angle": 0.4}}, 1e-5, PRESSES),
    "gradient": ("glove", {"skin.top.map": {"kind": "gradient", "x": 0.3}}, 1e-5, PRESSES),
    "constant map": ("glove", {"skin.foam.map": {"kind": "constant", "value": 1.2}}, 1e-8, PRESSES),
    "leads": ("glove", {"leads": {"stray_capacitance": 5e-12, "resistance": 3.0}}, 1e-8, PRESSES),
    "earth": ("strip-1x4", {"skin.foam.thickness": 4e-3, "surroundings": EARTH}, 1e-8, PRESSES),
    "a body": (
        "strip-1x4",
        {"skin.foam.thickness": 4e-3, "surroundings": {**EARTH, "body": BODY}},
        1e-8,
        PRESSES,
    ),
    "rim and thickness": (
        "strip-1x4",
        {"skin.foam.thickness": 4e-3, "surroundings": {"rim": True, "thickness": True}},
        1e-6,
        PRESSES,
    ),
    "rim by a body": (
        "strip-1x4",
        {"skin.foam.thickness": 4e-3, "surroundings": {"rim": True, "body": BODY}},
        1e-6,
        PRESSES,
    ),
    "floating": (
        "strip-1x4",
        {"skin.foam.thickness": 4e-3, "surroundings": {"low": "floating", "rim": True}},
        1e-6,
        PRESSES,
    ),
    "a finger": (
        "strip-1x4",
        {"skin.foam.thickness": 4e-3, "surroundings": EARTH, "press.finger": 3e-12},
        1e-8,
        PRESSES,
    ),
    "foam by force": (
        "strip-1x4",
        {"skin.foam": FOAM},
        1e-8,
        ("1,2:0.5N", "disc(0.05,0.01,0.004):1N"),
    ),
}


def answers() -> Iterator[tuple[str, float, float]]:
    """What is asked, the answer, and how far another right answer may be from it."""
    yield from _sweeps()
    yield from _calibration()
    yield from _limits()
    yield from _predictions()


def _sweeps() -> Iterator[tuple[str, float, float]]:
    for skin, (name, changes, rtol, presses) in SKINS.items():
        scene = rcskin.load(name).with_(changes)
        if name != "knit-36":  # whose reader has frequencies of its own
            scene = scene.with_({"sweep.frequencies": FREQUENCIES})
        found = rcskin.sweep(scene, list(presses), rtol=rtol)
        for quantity in (each for each in ("Rs", "Cp", "gain") if each in found):
            values, errors = found[quantity].values, found[f"{quantity}_error"].values
            for place in np.ndindex(values.shape):
                sweep, interface, frequency = place
                if frequency % max(1, values.shape[-1] // 3) or not np.isfinite(values[place]):
                    continue
                what = f"{skin}, {presses[sweep]}: {quantity} {interface} {frequency}"
                yield what, float(values[place].real), float(errors[place])


def _calibration() -> Iterator[tuple[str, float, float]]:
    """Intervals of what is fitted to sweeps with noise of skins that are not the scene's."""
    scene = rcskin.load("strip-1x5").with_({"sweep.frequencies": [1e3, 3e3, 1e4, 1e5]})
    scene = scene.with_({"skin.foam.loss_tangent": 0.01})
    other = {"skin.sheet_resistance": 61e3, "skin.foam.loss_tangent": 0.02}
    gradient = {"skin.foam.map": {"kind": "gradient", "x": 0.2}}
    for what, true, uneven in (("even", other, False), ("uneven", gradient, True)):
        sweeps = rcskin.measured(rcskin.sweep(scene.with_(true)))
        found = rcskin.calibrate(scene, sweeps, uneven=uneven)
        for name, (low, high) in found.intervals.items():
            yield f"{what} calibration: {name} from", float(low), 0.02 * (high - low)
            yield f"{what} calibration: {name} to", float(high), 0.02 * (high - low)


def _limits() -> Iterator[tuple[str, float, float]]:
    """Limits of accuracy; their margin is one draw."""
    draws = 500
    for name in ("strip-1x3", "sheet-3x3"):
        found = rcskin.limits(rcskin.load(name), "column", 1.5, draws=draws)
        yield f"limit: {name}", float(found.accuracy), 1 / draws


def _predictions() -> Iterator[tuple[str, float, float]]:
    """Probabilities of a classifier that learned from a data set, of sweeps with noise."""
    scene = rcskin.load("sheet-3x3").with_({"dataset.press": PRESSED})
    for estimator, quantities in (("ksvm-ovo", "dlnZ,dphase"), ("gaussian", None)):
        model = rcskin.train(rcskin.dataset(scene, 200), "column", estimator, quantities=quantities)
        found = rcskin.localize(model, rcskin.measured(rcskin.sweep(scene), seed=3))
        for place in np.ndindex(np.shape(found.chances)):
            sweep, label = place
            yield f"{estimator}: {sweep} {label}", float(np.asarray(found.chances)[place]), 1e-6


def main() -> None:
    """Write the answers."""
    with ANSWERS.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["question", "answer", "margin"])
        rows.writerows((what, repr(value), f"{error:.2g}") for what, value, error in answers())


if __name__ == "__main__":
    main()
