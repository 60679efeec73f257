"""A knitted pad against a ladder of lumped elements, which shares no code with the model.

The yarn runs to and fro in courses. Each element has a resistance and a capacitance to earth;
elements that lie next to each other in neighbouring courses may be coupled by a capacitance.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene
from scipy.linalg import eigh

ELEMENTS = 540
"""Of the yarn: 15 of each key, so that courses and keys end between elements."""
KEYS, COURSES = 36, 6
FEW = load_scene("knit-36").with_({"sweep.frequencies": [2e3, 1e4, 25750.0]})


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

    def gains(self, frequency: np.ndarray, key: int = 0, touch: float = 0.0) -> np.ndarray:
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

    def _elements(self) -> tuple[np.ndarray, np.ndarray]:
        """Conductance in S and capacitance to earth in F of each element."""
        random, of_key = np.random.default_rng(self.seed), ELEMENTS // KEYS
        x = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
        rough = np.repeat(1 + self.roughness * random.standard_normal((2, KEYS)), of_key, axis=1)
        resistance, capacitance = rough * (1 + self.slope * np.stack([2 * x - 1, 1 - 2 * x]))
        return (
            resistance.sum() / (self.R * resistance),
            self.C * capacitance / capacitance.sum(),
        )

    def _touched(self, key: int) -> np.ndarray:
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


def _neighbours() -> tuple[np.ndarray, np.ndarray]:
    """Nodes that lie next to each other in neighbouring courses; the yarn turns at their ends."""
    long = ELEMENTS // COURSES
    one = np.arange((COURSES - 1) * long)
    course, along = np.divmod(one, long)
    return one, (course + 2) * long - 1 - along


def _between(one: np.ndarray, other: np.ndarray, each: np.ndarray) -> np.ndarray:
    """Matrix of two-terminal elements between nodes."""
    found = np.zeros((ELEMENTS + 1, ELEMENTS + 1))
    for row, column, sign in ((one, one, 1), (other, other, 1), (one, other, -1), (other, one, -1)):
        np.add.at(found, (row, column), sign * each)
    return found


def gains(scene, key: int = 0, touch: float = 0.0) -> np.ndarray:
    """Magnitudes by the model, shape (end, frequency). key: from 1, 0 for none. touch: F."""
    text = f"1,{key}:{1e12 * float(touch)!r}pF" if key else "none"
    return np.abs(Solver(scene.parts).solve(press_on(scene.parts.skin, scene.press, text)).Z)


@pytest.mark.parametrize(("key", "touch"), [(0, 0.0), (1, 40e-12), (20, 20e-12)])
def test_a_uniform_ladder_is_the_yarn(key, touch):
    found = np.abs(Ladder().gains(FEW.frequencies, key, touch))
    np.testing.assert_allclose(found, gains(FEW, key, touch), rtol=2e-3)


def test_a_ladder_read_from_its_other_end_has_mirrored_gains():
    here, there = (Ladder().gains(FEW.frequencies, key, 30e-12) for key in (4, KEYS - 3))
    np.testing.assert_allclose(here, there[::-1], rtol=1e-9)


def test_coupled_courses_and_touches_beside_change_the_gains_and_keep_the_charge():
    """At low frequency a touch counts wholly, on whatever course it lies."""
    slow = np.array([1.0])
    whole, beside = (Ladder(beside=share).gains(slow, 9, 30e-12) for share in (0.0, 0.5))
    np.testing.assert_allclose((1 - whole).sum(), (1 - beside).sum(), rtol=1e-3)
    apart, coupled = (Ladder(coupling=c).gains(FEW.frequencies) for c in (0.0, 2e-12))
    assert (np.abs(coupled / apart - 1) > 1e-4).any()
