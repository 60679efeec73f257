"""Sweeps of a skin in closed form: a chain of uniform RC segments, one of them pressed."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import UNPRESSED, build, concatenate

FREQUENCY = np.geomspace(1e3, 200e3, 20)
RESISTANCE = 100e3
"""Ohm: two electrodes of 50 kohm/sq, one after the other, over a square."""
CAPACITANCE = 70e-12
"""F, of the whole skin at rest."""
FACTOR = 2.0
"""Capacitance of a pressed pixel over its rest value."""


def line_impedance(capacitance, frequency):
    """Z in ohm of equal segments of total RESISTANCE, open at the end, fed at the start.

    The chain matrix of a segment is [[cosh gl, Zc sinh gl], [sinh gl / Zc, cosh gl]] with
    g = sqrt(s r c), Zc = sqrt(r / (s c)); a load of admittance Y behind it is seen in front of it
    as (Y + tanh gl / Zc) / (1 + Y Zc tanh gl).

    capacitance: F, of each segment from the fed end on. frequency: Hz.
    """
    s, resistance = 2j * np.pi * frequency, RESISTANCE / len(capacitance)
    Y = np.zeros_like(s)
    for C in capacitance[::-1]:
        Zc, tanh = np.sqrt(resistance / (s * C)), np.tanh(np.sqrt(s * resistance * C))
        Y = (Y + tanh / Zc) / (1 + Y * Zc * tanh)
    return 1 / Y


def true_impedance(pixel, factor, shape, interfaces, frequency):
    """Z (interface, frequency) of a skin of `shape` (rows, columns), read from "left", "right"."""
    (row, column), (rows, columns) = pixel, shape
    capacitance = np.full(columns, CAPACITANCE / columns)
    if row:
        capacitance[column - 1] *= 1 + (factor - 1) / rows
    seen_from = {"left": capacitance, "right": capacitance[::-1]}
    return np.array([line_impedance(seen_from[name], frequency) for name in interfaces])


@pytest.fixture(scope="session")
def make_sweeps():
    """A function that makes seeded sweeps of every pixel of a skin, each pressed several times."""

    def make(
        rows=1,
        columns=3,
        repetitions=6,
        *,
        unpressed=True,
        rests=1,
        noise=0.003,
        spread=0.1,
        interfaces=("left",),
        frequency=FREQUENCY,
        session=0,
        seed=0,
    ):
        """noise: relative on |Z| and in rad on its phase. spread: relative, of the press. rests:
        sweeps at rest that it begins with, as a recording does."""
        rng = np.random.default_rng(seed)
        pressed = [(i, j) for i in range(1, rows + 1) for j in range(1, columns + 1)]
        pixels = [(0, 0)] * (rests - 1) + ([(0, 0)] * unpressed + pressed) * repetitions
        factors = 1 + (FACTOR - 1) * (1 + spread * rng.standard_normal(len(pixels)))
        Z = np.array(
            [
                true_impedance(pixel, factor, (rows, columns), interfaces, frequency)
                for pixel, factor in zip(pixels, factors, strict=True)
            ]
        )
        gain, phase = noise * rng.standard_normal((2, *Z.shape))
        return build(
            Z * (1 + gain) * np.exp(1j * phase),
            frequency,
            interface=interfaces,
            press=[f"{i},{j}:{FACTOR}" if i else UNPRESSED for i, j in pixels],
            row=[i for i, _ in pixels],
            column=[j for _, j in pixels],
            session=[session] * len(pixels),
            attributes={"scene": 'name = "line"\n'},
        ).dataset()

    return make


@pytest.fixture(scope="session")
def strip(make_sweeps):
    """A strip of three pixels, well told apart: 24 sweeps, 6 of them unpressed."""
    return make_sweeps()


@pytest.fixture(scope="session")
def sheet(make_sweeps):
    """A sheet of 3 x 3 pixels read from both sides on two mountings: 120 sweeps."""
    return concatenate(
        [
            make_sweeps(3, 3, interfaces=("left", "right"), session=session, seed=session)
            for session in (1, 2)
        ]
    )
