"""What became of one case."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

KNOWN = 0.2
"""Doubt over true or told error, whichever is larger, up to which their ratio says something."""
Outcome = Literal["judged", "refused", "not judged", "failed"]
Values = list[list[list[float]]]


@dataclass(frozen=True)
class Verdict:
    """What became of one case.

    reason: why it was not judged. frequency: Hz. true, told, doubt: relative errors of Rs and of
    Cp, shape (2, interface, frequency): against the reference, by the answer, and of the reference.
    seconds: of a processor, to the answer, and to the reference.
    """

    kind: str
    seed: int
    rtol: float
    outcome: Outcome
    reason: str = ""
    model: str = ""
    frequency: tuple[float, ...] = ()
    true: Values | None = None
    told: Values | None = None
    doubt: Values | None = None
    seconds: tuple[float, float] = (0.0, 0.0)

    def record(self) -> dict[str, object]:
        """As JSON has it."""
        return asdict(self)

    @property
    def errors(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """True, told and doubtful, each of shape (2, interface, frequency)."""
        assert self.true is not None and self.told is not None and self.doubt is not None
        return np.array(self.true), np.array(self.told), np.array(self.doubt)

    @property
    def broken(self) -> bool:
        """Whether anything is further off than was asked, the reference's doubt set aside."""
        if self.outcome != "judged":
            return False
        true, _, doubt = self.errors
        return bool((true - doubt > self.rtol).any())

    @property
    def boasted(self) -> bool:
        """Whether anything is further off than was told, the reference's doubt set aside."""
        if self.outcome != "judged":
            return False
        true, told, doubt = self.errors
        return bool((true - doubt > told).any())

    @property
    def ratios(self) -> NDArray[np.float64]:
        """True over told errors where the reference tells, and where it tells of too little."""
        if self.outcome != "judged":
            return np.empty(0)
        true, told, doubt = self.errors
        sure = doubt <= KNOWN * np.maximum(true, told)
        return (true / told)[sure | (true - doubt > told)]

    @property
    def overstated(self) -> float:
        """Largest error told over the largest true one; nan where a reference tells of none."""
        if self.outcome != "judged":
            return np.nan
        true, told, doubt = self.errors
        return float(told.max() / true.max()) if doubt.max() < true.max() else np.nan

    def line(self) -> str:
        """For people: what is wrong, and how to have it again."""
        named = f"{self.kind} seed {self.seed} rtol {self.rtol:g}"
        if self.outcome != "judged":
            return f"{self.outcome}: {named}: {self.reason}"
        true, told, doubt = self.errors
        worst = ((true - doubt) / told).argmax()
        name, interface, f = (int(k) for k in np.unravel_index(worst, true.shape))
        said = "broken" if self.broken else "boasted" if self.boasted else "kept"
        return (
            f"{said}: {named}: {('Rs', 'Cp')[name]} off by {true[name, interface, f]:.2e}, told "
            f"{told[name, interface, f]:.2e}, at {self.frequency[f]:.6g} Hz; at most "
            f"{true.max():.2e}, by {self.model}"
        )
