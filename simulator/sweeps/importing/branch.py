"""Choice of the reactance: Rs and Cp leave two solutions, and a sweep may pass between them.

With B = omega Cp = -X/(Rs^2 + X^2), the reactance solves B X^2 + X + B Rs^2 = 0. So there are two,
X1 X2 = Rs^2 and X1 + X2 = -1/B, and s = (X^2 - Rs^2)/(X^2 + Rs^2) is root(1 - (2 B Rs)^2) of the
capacitive one, |X| >= Rs, and minus that of the resistive one. Z of a network is analytic in the
frequency, and so is s: where a sweep passes -45 degrees, s goes straight on through 0, from one
branch to the other. The same sweep with all signs of s changed is not causal. So of all ways to
pass, the right one is nearest to a passive RC network (see `passivity`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Mask, Real
from ..errors import InputError
from ..passivity import RESOLUTION, distance_from_rc

RULES = {
    "followed": "X is that of a passive network (Kramers-Kronig), followed past -45 degrees",
    "capacitive": "X is the one with |X| >= Rs, a phase between -90 and -45 degrees",
    "resistive": "X is the one with |X| <= Rs, a phase between -45 and 0 degrees",
}
NEAR = 0.3
"""|s| below which noise or a coarse step may hide whether a sweep crosses -45 degrees; this is
within 9 degrees of it."""
CROSSING = 0.15
"""|s| that noise leaves where a sweep crosses -45 degrees; a coarse step may leave more."""
MAX_CROSSINGS = 2
NOISE, MANY = 3e-3, 10
"""Relative noise that a network may fit by chance, and the number of frequencies that show it."""
CERTAIN = 3.0
"""Factor of the misfit of the nearest network, or by chance, from which a branch is excluded."""
NO_NETWORK = 0.1
"""Root mean square misfit from which a spectrum is not that of a network."""
MIN_FREQUENCIES, FEW = 3, 5
"""Smallest number of frequencies at which a network is no network on the other branch, and the
largest number at which all ways to change between branches are tried."""
MAX_LISTED = 6


@dataclass(frozen=True)
class BranchChoice:
    """Z in ohm on the chosen branch, and a mask of doubtful readings, of equal shape.

    Readings are doubtful within NEAR of -45 degrees, and where both branches fit a network, or
    neither does.
    """

    Z: Complex
    doubtful: Mask


def checked_branch(branch: str) -> str:
    """Returns the branch if its name is known; raises InputError otherwise."""
    if branch not in RULES:
        raise InputError(f"`branch` must be one of {', '.join(RULES)}, got {branch!r}")
    return branch


def choose_branches(
    Z: NDArray[np.complexfloating], frequency: Real, branch: str, taken: Mask
) -> BranchChoice:
    """Applies `choose_branch` to the readings taken of every interface; NaN for the others.

    Z: shape (sweep, interface, frequency). taken: shape (interface, frequency).
    """
    found = BranchChoice(
        np.full(Z.shape, np.nan, dtype=np.complex128), np.zeros(Z.shape, dtype=np.bool_)
    )
    for interface, read in enumerate(taken):
        own = choose_branch(Z[:, interface, read], frequency[read], branch)
        found.Z[:, interface, read], found.doubtful[:, interface, read] = own.Z, own.doubtful
    return found


def choose_branch(Z: NDArray[np.complexfloating], frequency: Real, branch: str) -> BranchChoice:
    """Impedance on the branch that a rule of RULES selects.

    Z: ohm, on the capacitive branch, shape (..., frequency). frequency: Hz, ascending.
    """
    Z = np.asarray(Z, dtype=np.complex128)
    s = (Z.imag**2 - Z.real**2) / np.abs(Z) ** 2
    other = Z.real + 1j * np.divide(Z.real**2, Z.imag, out=np.zeros(s.shape), where=Z.imag != 0)
    capacitive = np.full(s.shape, branch != "resistive")
    doubtful = np.zeros(s.shape, dtype=np.bool_)
    if branch == "followed":
        for sweep in np.ndindex(s.shape[:-1]):
            patterns = _patterns(s[sweep])
            capacitive[sweep], doubtful[sweep] = _of_network(
                Z[sweep], other[sweep], patterns, frequency
            )
        doubtful |= s < NEAR
    return BranchChoice(np.where(capacitive, Z, other), doubtful)


def _patterns(s: Real) -> list[Mask]:
    """The ways in which a sweep may change between branches, True on the capacitive one."""
    if s.size <= FEW:
        return [np.array(signs) for signs in product((True, False), repeat=s.size)]
    padded = np.pad(s, 1, constant_values=np.inf)
    before, after = padded[:-2], padded[2:]
    step = np.minimum(np.maximum(before, after), 1.0) - s
    lowest = np.flatnonzero((s <= before) & (s <= after) & (s < np.maximum(CROSSING, step)))
    lowest = np.sort(lowest[np.argsort(s[lowest])][:MAX_CROSSINGS])
    found: dict[tuple[bool, ...], Mask] = {}
    for start, *steps in product((True, False), *([(None, 0, 1)] * len(lowest))):
        pattern = np.full(s.shape, start)
        for place, after_it in zip(lowest, steps, strict=True):
            if after_it is not None:
                pattern[place + after_it :] ^= True
        found.setdefault(tuple(pattern), pattern)
    return list(found.values())


def _of_network(
    Z: Complex, other: Complex, patterns: list[Mask], frequency: Real
) -> tuple[Mask, Mask]:
    """The pattern with which a sweep is nearest to a passive network, and its doubtful readings.

    If several are as near as noise allows, one that begins on the capacitive branch is taken.
    Z, other: ohm, on the capacitive and on the resistive branch.
    """
    everywhere = np.ones(Z.shape, dtype=np.bool_)
    if len(frequency) < MIN_FREQUENCIES:
        return patterns[0], everywhere
    misfits = np.array([distance_from_rc(np.where(each, Z, other), frequency) for each in patterns])
    by_chance = NOISE if len(frequency) < MANY else RESOLUTION
    possible = misfits <= CERTAIN * max(misfits.min(), by_chance)
    begin = np.array([each[0] for each in patterns])
    if (possible & begin).any():
        misfits[~begin] = np.inf
    chosen = patterns[int(misfits.argmin())]
    apart = [each != chosen for each, fits in zip(patterns, possible, strict=True) if fits]
    return chosen, everywhere if misfits.min() > NO_NETWORK else np.any(apart, axis=0)


def branch_attributes(
    found: BranchChoice, branch: str, frequency: Real, interfaces: Sequence[str]
) -> dict[str, str]:
    """Attributes of sweeps: `branch_rule`, and `branch_doubt` if some readings are doubtful.

    found: shape (sweep, interface, frequency).
    """
    rule, doubt = RULES[branch], _doubts(found, frequency, interfaces)
    if branch == "followed":
        rule += f": {_begins(found.Z)} at the lowest frequency"
    return {"branch_rule": rule} | ({"branch_doubt": doubt} if doubt else {})


def _begins(Z: Complex) -> str:
    """The branches on which sweeps begin. Z: ohm, shape (sweep, interface, frequency)."""
    first = np.take_along_axis(Z, np.isfinite(Z).argmax(axis=-1)[..., None], axis=-1)[..., 0]
    resistive = (np.abs(first.imag) < first.real).any(axis=-1)
    if resistive.all() or not resistive.any():
        return "|X| <= Rs" if resistive.all() else "|X| >= Rs"
    return f"|X| >= Rs, and in sweeps {runs_text(np.flatnonzero(resistive).tolist())} |X| <= Rs"


def _doubts(found: BranchChoice, frequency: Real, interfaces: Sequence[str]) -> str:
    """Describes the readings that may be on the wrong branch; empty if there are none."""
    groups: dict[tuple[int, tuple[int, ...]], list[int]] = {}
    for sweep, place in np.argwhere(found.doubtful.any(axis=-1)):
        readings = tuple(np.flatnonzero(found.doubtful[sweep, place]).tolist())
        groups.setdefault((place, readings), []).append(int(sweep))
    if not groups:
        return ""
    listed = [
        f"interface {interfaces[place]} {_range(frequency[list(readings)])} in "
        f"sweep{'s' if len(sweeps) > 1 else ''} {runs_text(sweeps)}"
        for (place, readings), sweeps in sorted(groups.items())
    ]
    further = [f"{len(listed) - MAX_LISTED} groups more"] if len(listed) > MAX_LISTED else []
    return (
        f"{found.doubtful.sum()} of {np.isfinite(found.Z).sum()} readings may be on the wrong "
        f"branch: {'; '.join([*listed[:MAX_LISTED], *further])}; their phase is near -45 degrees, "
        "or a passive network fits both branches or neither"
    )


def _range(frequency: Real) -> str:
    """Ascending frequencies in Hz as text: the only one, or the first and the last."""
    if len(frequency) == 1:
        return f"at {frequency[0]:.6g} Hz"
    return f"from {frequency[0]:.6g} to {frequency[-1]:.6g} Hz"


def runs_text(numbers: Sequence[int], most: float = math.inf) -> str:
    """Ascending numbers as text with consecutive ones joined: `0, 2-4`; at most so many runs."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    shown = [f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs]
    return ", ".join(shown if len(shown) <= most else [*shown[: int(most)], "..."])
