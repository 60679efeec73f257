"""Knitted pads as ladders of lumped elements: twins that share no code with the model.

The yarn runs to and fro in courses. Each element has a resistance and a capacitance to earth;
elements that lie next to each other in neighbouring courses may be coupled by a capacitance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

ELEMENTS = 540
"""Of the yarn: 15 of each key, so that courses and keys end between elements."""
KEYS, COURSES = 36, 6
BITS = 12


@dataclass(frozen=True)
class Ladder:
    """A pad. R: of the yarn, ohm. C: to earth, F. inputs: of the amplifiers at both ends, F.

    slope, roughness: relative change of the resistance from the middle to the end, and its standard
    deviation from key to key; capacitances to earth vary as much. coupling: between two
    neighbouring courses, F. beside: share of a touch that lies on the neighbouring course.
    """

    R: float = 0.5e6
    C: float = 20e-12
    inputs: tuple[float, float] = (10e-12, 10e-12)
    series: tuple[float, float] = (1e6, 1e6)
    slope: float = 0.0
    roughness: float = 0.0
    coupling: float = 0.0
    beside: float = 0.0
    seed: int = 1

    def gains(
        self, frequency: NDArray[np.float64], key: int = 0, touch: float = 0.0
    ) -> NDArray[np.complex128]:
        """V / V_s at both ends, shape (end, frequency). key: from 1, 0 for none. touch: F."""
        conductance, to_earth = self._elements()
        here = np.arange(ELEMENTS)
        source = np.zeros(ELEMENTS + 1)
        source[[0, -1]] = 1 / np.array(self.series)
        K = _between(here, here + 1, conductance) + np.diag(source)
        C = np.zeros(ELEMENTS + 1)
        C[:-1] += to_earth / 2
        C[1:] += to_earth / 2
        C[[0, -1]] += self.inputs
        if key:
            C += touch * self._touched(key)
        one, other = _neighbours()
        each = np.full(len(one), self.coupling * (COURSES - 1) / len(one))
        poles, modes = eigh(K, np.diag(C) + _between(one, other, each))
        excited = modes[[0, -1]] * (source @ modes)
        return excited @ (1 / (poles[:, None] + 2j * np.pi * frequency))

    def _elements(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Conductance in S and capacitance to earth in F of each element."""
        random, of_key = np.random.default_rng(self.seed), ELEMENTS // KEYS
        x = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
        rough = np.repeat(1 + self.roughness * random.standard_normal((2, KEYS)), of_key, axis=1)
        resistance, capacitance = rough * (1 + self.slope * np.stack([2 * x - 1, 1 - 2 * x]))
        return (
            resistance.sum() / (self.R * resistance),
            self.C * capacitance / capacitance.sum(),
        )

    def _touched(self, key: int) -> NDArray[np.float64]:
        """Share of a touch at each node."""
        of_key, share = ELEMENTS // KEYS, np.zeros(ELEMENTS + 1)
        own = np.arange((key - 1) * of_key, key * of_key + 1)
        share[own] = (1 - self.beside) / of_key
        share[own[[0, -1]]] /= 2
        one, other = _neighbours()
        next_course, course_before = other[np.isin(one, own)], one[np.isin(other, own)]
        across = next_course if len(next_course) > 1 else course_before
        share[across] += self.beside / len(across)
        return share


def with_noise(gains: NDArray[np.complex128], random: np.random.Generator) -> NDArray[np.float64]:
    """Magnitudes as a converter of BITS reads them, full scale at a gain of 1."""
    step = 2.0**-BITS
    read = np.abs(gains) + step * random.standard_normal(gains.shape) / 2
    return np.round(read / step) * step


def _neighbours() -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Nodes that lie next to each other in neighbouring courses; the yarn turns at their ends."""
    long = ELEMENTS // COURSES
    one = np.arange((COURSES - 1) * long)
    course, along = np.divmod(one, long)
    return one, (course + 2) * long - 1 - along


def _between(
    one: NDArray[np.int64], other: NDArray[np.int64], each: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Matrix of two-terminal elements between nodes."""
    found = np.zeros((ELEMENTS + 1, ELEMENTS + 1))
    for row, column, sign in ((one, one, 1), (other, other, 1), (one, other, -1), (other, one, -1)):
        np.add.at(found, (row, column), sign * each)
    return found
