"""Choice of the reactance: Rs and Cp leave two solutions, and a sweep may pass between them.

With B = omega Cp = -X/(Rs^2 + X^2), the reactance solves B X^2 + X + B Rs^2 = 0. So there are two,
X1 X2 = Rs^2 and X1 + X2 = -1/B, and s = (X^2 - Rs^2)/(X^2 + Rs^2) is root(1 - (2 B Rs)^2) of the
capacitive one, |X| >= Rs, and minus that of the resistive one. Z of a network is analytic in the
frequency, and so is s: where a sweep passes -45 degrees, s goes straight on through 0, while
each branch by itself has a kink there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Complex, Mask, Real
from ...errors import InputError

RULES = {
    "followed": "X is |X| >= Rs at the lowest frequency, and is followed from there without a kink",
    "capacitive": "X is the one with |X| >= Rs, a phase between -90 and -45 degrees",
    "resistive": "X is the one with |X| <= Rs, a phase between -45 and 0 degrees",
}
NEAR = 0.3
"""|s| below which noise or a coarse step may hide whether a sweep crosses -45 degrees; this is
within 9 degrees of it."""
MAX_LISTED = 6


@dataclass(frozen=True)
class BranchChoice:
    """Z in ohm on the chosen branch, and a mask of doubtful readings, of equal shape.

    Once a followed sweep comes near -45 degrees, all further readings depend on the choice there.
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
    s = (Z.imag**2 - Z.real**2) / np.abs(Z) ** 2
    capacitive, doubtful = (
        np.full(s.shape, branch != "resistive"),
        np.zeros(s.shape, dtype=np.bool_),
    )
    if branch == "followed":
        capacitive = _followed(s, np.log(frequency))
        doubtful = np.logical_or.accumulate((s < NEAR) | ~capacitive, axis=-1)
    other = Z.real + 1j * np.divide(Z.real**2, Z.imag, out=np.zeros(s.shape), where=Z.imag != 0)
    return BranchChoice(np.where(capacitive, Z, other), doubtful)


def _followed(s: Real, x: Real) -> Mask:
    """True where s >= 0, for the signs that give the smoothest curve; the first sign is positive.

    Minimizes the sum of squared distances of each point from the chord of its neighbours, by
    dynamic programming over the signs of two neighbours.
    """
    points = s.shape[-1]
    if points < 3:
        return np.ones(s.shape, dtype=np.bool_)
    both = np.stack([s, -s], axis=-1)
    cost = np.zeros((*s.shape[:-1], 2, 2))
    cost[..., 1, :] = np.inf
    before = []
    for k in range(2, points):
        share = (x[k - 1] - x[k - 2]) / (x[k] - x[k - 2])
        first, middle, last = (both[..., place, :] for place in (k - 2, k - 1, k))
        chord = (1 - share) * first[..., :, None, None] + share * last[..., None, None, :]
        total = cost[..., None] + (middle[..., None, :, None] - chord) ** 2
        before.append(total.argmin(axis=-3).reshape(*s.shape[:-1], 4))
        cost = total.min(axis=-3)
    negative = np.empty(s.shape, dtype=np.intp)
    negative[..., -2], negative[..., -1] = np.divmod(cost.reshape(*s.shape[:-1], 4).argmin(-1), 2)
    for k in range(points - 1, 1, -1):
        pair = 2 * negative[..., k - 1] + negative[..., k]
        negative[..., k - 2] = np.take_along_axis(before[k - 2], pair[..., None], -1)[..., 0]
    return negative == 0


def branch_attributes(
    found: BranchChoice, branch: str, frequency: Real, interfaces: Sequence[str]
) -> dict[str, str]:
    """Attributes of sweeps: `branch_rule`, and `branch_doubt` if some readings are doubtful.

    found: shape (sweep, interface, frequency).
    """
    doubt = _doubts(found, frequency, interfaces)
    return {"branch_rule": RULES[branch]} | ({"branch_doubt": doubt} if doubt else {})


def _doubts(found: BranchChoice, frequency: Real, interfaces: Sequence[str]) -> str:
    """Describes the readings that may be on the wrong branch; empty if there are none."""
    onset = found.doubtful.argmax(axis=-1)
    groups: dict[tuple[int, int], list[int]] = {}
    for sweep, place in np.argwhere(found.doubtful.any(axis=-1)):
        groups.setdefault((place, onset[sweep, place]), []).append(int(sweep))
    if not groups:
        return ""
    listed = [
        f"interface {interfaces[place]} from {frequency[first]:.6g} Hz on in "
        f"sweep{'s' if len(sweeps) > 1 else ''} {_ranges(sweeps)}"
        for (place, first), sweeps in sorted(groups.items())
    ]
    further = [f"{len(listed) - MAX_LISTED} groups more"] if len(listed) > MAX_LISTED else []
    read = np.isfinite(found.Z).sum()
    return (
        f"{found.doubtful.sum()} of {read} readings may be on the wrong branch, "
        f"beyond a phase near -45 degrees: {'; '.join([*listed[:MAX_LISTED], *further])}"
    )


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers as text with consecutive ones joined: `0, 2-4`."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)
