"""What became of one case."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

KNOWN = 0.2
"""Largest uncertainty of the true error, over it or the estimate, for their ratio to count."""
Outcome = Literal["judged", "refused", "not judged", "failed"]
Values = list[list[list[float]]]


@dataclass(frozen=True)
class Verdict:
    """What became of one case.

    reason: why it was not judged. frequency: Hz. true, estimated, uncertain: relative errors of Rs
    and of Cp, shape (2, interface, frequency): against the reference, as the answer estimates them,
    and of the reference.
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
    estimated: Values | None = None
    uncertain: Values | None = None
    seconds: tuple[float, float] = (0.0, 0.0)

    def record(self) -> dict[str, object]:
        """As JSON has it."""
        return asdict(self)

    @property
    def errors(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """True, estimated and uncertain, each of shape (2, interface, frequency)."""
        assert self.true is not None and self.estimated is not None and self.uncertain is not None
        return np.array(self.true), np.array(self.estimated), np.array(self.uncertain)

    @property
    def broken(self) -> bool:
        """Whether an error exceeds the tolerance by more than the reference is uncertain."""
        if self.outcome != "judged":
            return False
        true, _, uncertain = self.errors
        return bool((true - uncertain > self.rtol).any())

    @property
    def underestimated(self) -> bool:
        """Whether an error exceeds its estimate by more than the reference is uncertain."""
        if self.outcome != "judged":
            return False
        true, estimated, uncertain = self.errors
        return bool((true - uncertain > estimated).any())

    @property
    def ratios(self) -> NDArray[np.float64]:
        """True over estimated errors where the reference is sure enough, or shows the estimate too
        small."""
        if self.outcome != "judged":
            return np.empty(0)
        true, estimated, uncertain = self.errors
        sure = uncertain <= KNOWN * np.maximum(true, estimated)
        return (true / estimated)[sure | (true - uncertain > estimated)]

    @property
    def overstated(self) -> float:
        """Largest estimate over the largest true error; nan if the reference is less sure."""
        if self.outcome != "judged":
            return np.nan
        true, estimated, uncertain = self.errors
        return float(estimated.max() / true.max()) if uncertain.max() < true.max() else np.nan

    def line(self) -> str:
        """For people: what is wrong, and how to have it again."""
        named = f"{self.kind} seed {self.seed} rtol {self.rtol:g}"
        if self.outcome != "judged":
            return f"{self.outcome}: {named}: {self.reason}"
        true, estimated, uncertain = self.errors
        worst = ((true - uncertain) / estimated).argmax()
        name, interface, f = (int(k) for k in np.unravel_index(worst, true.shape))
        said = "broken" if self.broken else "above its estimate" if self.underestimated else "kept"
        return (
            f"{said}: {named}: {('Rs', 'Cp')[name]} off by {true[name, interface, f]:.2e}, "
            f"estimate {estimated[name, interface, f]:.2e}, at {self.frequency[f]:.6g} Hz; at most "
            f"{true.max():.2e}, by {self.model}"
        )
