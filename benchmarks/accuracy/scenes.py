"""Skins on which ways to Rs and Cp are judged, each with the impedance that is true of it.

And scenes and presses drawn at random from far beyond what is ever built.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals import finite_elements
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

EDGES = ("left", "right", "bottom", "top")
SPANS = ((0.0, 1.0), (0.0, 1.0), (0.2, 0.7), (0.5, 1.0), (0.31, 0.34))
FREQUENCIES = 5
U_RANGE = (1e-3, 1e5)
KNEE = 1e3
"""Hz, where omega R C L² is 1: all of U_RANGE are frequencies that a scene may have."""


def logarithmic(rng: np.random.Generator, low: float, high: float) -> float:
    """A positive number, its logarithm evenly distributed."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def random_scene(rng: np.random.Generator, u_range: tuple[float, float] = U_RANGE) -> Scene:
    """Any foils on any edges, sheets up to 1e6 apart, 1 to 8 pixels a side.

    u_range: where the middle frequency's omega R C L² lies.
    """
    top, contrast = logarithmic(rng, 1e2, 1e4), 1.0
    if rng.random() < 0.5:
        contrast = logarithmic(rng, 1e-6, 1e6)
    bottom = top * contrast
    length, width = logarithmic(rng, 0.02, 0.2), logarithmic(rng, 0.02, 0.2)
    contacts = _foils(rng, "top", top) + _foils(rng, "bottom", bottom)
    c = 1 / (2 * np.pi * KNEE * (top + bottom) * max(length, width) ** 2)
    middle = logarithmic(rng, *u_range)
    spread = np.geomspace(0.1, 10, FREQUENCIES)
    return Scene.model_validate(
        {
            "name": "random",
            "skin": {
                "length": length,
                "width": width,
                "top": {"sheet_resistance": top},
                "bottom": {"sheet_resistance": bottom},
                "foam": {
                    "capacitance_per_area": c,
                    "loss_tangent": float(rng.choice([0.0, 0.0, 0.05])),
                },
            },
            "contact": contacts,
            "interface": [_interface(rng, contacts)],
            "pixels": {"rows": int(rng.integers(1, 9)), "columns": int(rng.integers(1, 9))},
            "sweep": {"frequencies": list(KNEE * middle * spread)},
        }
    )


def random_press(rng: np.random.Generator, scene: Scene) -> Press:
    """Nothing, one touch or up to three, the capacitance there 0.01 to 1000 times that at rest."""
    rows, columns = scene.pixels.rows, scene.pixels.columns
    count = min(int(rng.integers(0, 4)), rows * columns)
    pixels = sorted(rng.choice(rows * columns, count, replace=False).tolist())
    low, high = ((0.01, 1000.0), (1.2, 3.0))[int(rng.random() < 0.5)]
    return Press(
        tuple(Touch(p // columns + 1, p % columns + 1, logarithmic(rng, low, high)) for p in pixels)
    )


def _foils(rng: np.random.Generator, electrode: str, sheet_resistance: float) -> list[dict]:
    """On one or two edges, ideal or with a film, which may be thin or as resistive as the sheet."""
    edges = rng.choice(EDGES, int(rng.integers(1, 3)), replace=False)
    return [
        {
            "name": f"{electrode}-{edge}",
            "electrode": electrode,
            "edge": str(edge),
            "span": SPANS[int(rng.integers(len(SPANS)))],
            "resistance": rng.choice([0, 0, 1]) * sheet_resistance * logarithmic(rng, 1e-6, 1),
        }
        for edge in edges
    ]


def _interface(rng: np.random.Generator, contacts: list[dict]) -> dict:
    high, low = (
        str(rng.choice([c["name"] for c in contacts if c["electrode"] == electrode]))
        for electrode in ("top", "bottom")
    )
    return {"name": "meter", "high": [high], "low": [low]}


FACTOR = 2.0
AROUND_THE_KNEE = (0.1, 1.0, 10.0)
MAX_FREQUENCY = 1e12
"""Hz, that a scene may have; with u = 1 at KNEE those of u from 1e-9 to 1e9 are no larger."""


@dataclass(frozen=True)
class Case:
    """One skin and press; truth: Z in ohm at the scene's frequencies, shape (frequency,).

    cells conform to the pixels, askew do not. line: whether the skin is one.
    """

    scene: Scene
    press: Press
    truth: NDArray[np.complex128]
    cells: Cells
    askew: Cells
    line: bool

    @property
    def given(self) -> tuple[Scene, Press, NDArray[np.float64]]:
        """What every way is given."""
        return self.scene, self.press, self.scene.frequencies


@dataclass(frozen=True)
class Axis:
    """What is varied, over which values, and the case at each; listed: values for the table."""

    label: str
    case: Callable[[float], Case]
    values: tuple[float, ...]
    listed: tuple[float, ...]


def varied(name: str, u: Iterable[float], changes: dict[str, Any]) -> Scene:
    """A built-in scene with other tables, swept where omega (R_t + R_b) c L² is u.

    Where no scene may have such frequencies, its foam has the capacitance that puts u = 1 at KNEE.
    """
    tables = load_scene(name).model_dump(by_alias=True, exclude_none=True) | changes
    skin = Scene.model_validate(tables).skin
    per_capacitance = 2 * np.pi * skin.both_sheets * skin.length**2
    c, u = skin.foam.unpressed_capacitance_per_area, np.asarray([*u])
    if u.max() / (per_capacitance * c) > MAX_FREQUENCY:
        c = 1 / (per_capacitance * KNEE)
        foam = tables["skin"]["foam"] | {"capacitance_per_area": c}
        tables |= {"skin": tables["skin"] | {"foam": foam}}
    frequencies = [float(each) for each in u / (per_capacitance * c)]
    return Scene.model_validate(tables | {"sweep": {"frequencies": frequencies}})


def of_frequency(u: float) -> Case:
    """The strip with its middle pixel pressed, at one frequency."""
    scene, press = varied("strip-1x5", [u], {}), parse_press("1,3", FACTOR)
    truth = Line(scene.parts.skin, scene.parts.setup).solve(press, scene.frequencies).Z[0]
    return Case(scene, press, truth, Cells(320, 1), Cells(317, 1), line=True)


def of_contact(fraction: float) -> Case:
    """The sheet fed by foils in the middle of its left edge; true to some 1e-8."""
    span = (0.5 - fraction / 2, 0.5 + fraction / 2)
    foils = [foil.model_dump() | {"span": span} for foil in load_scene("sheet-5x5").contacts]
    scene = varied("sheet-5x5", AROUND_THE_KNEE, {"contact": foils})
    press = parse_press("2,3", FACTOR)
    layers = 0 if fraction == 1 else 7
    truth = finite_elements.over_resolved(scene, press, scene.frequencies, Elements(8, 1, layers))
    return Case(scene, press, truth, Cells(60, 60), Cells(59, 59), line=False)


def of_contrast(contrast: float) -> Case:
    """A sheet fed from opposite ends: Z = R1 R2/R (1 + 2l/sinh(1/l)) + l (R1² + R2²)/R coth(1/l).

    R1, R2: totals of the sheets, R their sum, l = 1/sqrt(s C R).
    """
    R = 100e3
    R1, R2 = R / (1 + contrast), R * contrast / (1 + contrast)
    skin = load_scene("sheet-5x5").skin.model_dump(exclude_none=True)
    skin |= {"top": {"sheet_resistance": R1}, "bottom": {"sheet_resistance": R2}}
    foils = [
        {"name": f"{electrode}-left", "electrode": electrode, "edge": edge}
        for electrode, edge in (("top", "left"), ("bottom", "right"))
    ]
    scene = varied("sheet-5x5", AROUND_THE_KNEE, {"skin": skin, "contact": foils})
    q = np.sqrt(1j * np.array(AROUND_THE_KNEE))
    Z = R1 * R2 / R * (1 + 2 / (q * np.sinh(q))) + (R1**2 + R2**2) / R / (q * np.tanh(q))
    return Case(scene, Press(), Z.astype(np.complex128), Cells(160, 1), Cells(158, 1), line=False)


def of_pixels(pixels: float) -> Case:
    """A strip of which every second pixel is pressed."""
    columns = int(pixels)
    scene = varied("strip-1x5", AROUND_THE_KNEE, {"pixels": {"rows": 1, "columns": columns}})
    press = Press(tuple(Touch(1, column, FACTOR) for column in range(1, columns + 1, 2)))
    truth = Line(scene.parts.skin, scene.parts.setup).solve(press, scene.frequencies).Z[0]
    cells = -(-320 // columns) * columns
    return Case(scene, press, truth, Cells(cells, 1), Cells(317, 1), line=True)


AXES = (
    Axis(
        "u = ωRCL²",
        of_frequency,
        tuple(10 ** (n / 2) for n in range(-18, 19)),
        (1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9),
    ),
    Axis("foil / edge", of_contact, (0.01, 0.03, 0.1, 0.3, 0.6, 1.0), (0.01, 0.1, 1.0)),
    Axis("R_b / R_t", of_contrast, tuple(10.0**n for n in range(7)), (1.0, 1e6)),
    Axis("pixels", of_pixels, (1, 2, 3, 5, 8, 16, 32), (32,)),
)
