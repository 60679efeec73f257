"""Scenes and presses drawn at random from far beyond what is ever built."""

from __future__ import annotations

import numpy as np
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene

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
