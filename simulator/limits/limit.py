"""Best accuracy of any classifier, as a result for scripts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..notebook_display import SmallChart, Tabular
from ..report.page import Rate, rate_bars

NORMAL = 1.96
"""Half of a 95 % interval, in standard errors."""


@dataclass(frozen=True, repr=False)
class Limit(Tabular):
    """Accuracy of the best classifier of a `target`, and its standard error.

    Unpacks into these two numbers. guess: accuracy of the best guess without a sweep.
    """

    target: str
    accuracy: float
    standard_error: float
    guess: float

    def __iter__(self) -> Iterator[float]:
        return iter((self.accuracy, self.standard_error))

    def _table(self) -> tuple[str, list[tuple[str, ...]]]:
        numbers = self.accuracy, self.standard_error, self.guess
        header = "accuracy", "standard_error", "guess"
        return f"Limit of {self.target}", [header, tuple(f"{each:.4f}" for each in numbers)]

    def _chart(self) -> SmallChart:
        off = NORMAL * self.standard_error
        ends = max(self.accuracy - off, 0.0), min(self.accuracy + off, 1.0)
        return rate_bars([Rate("best classifier", self.accuracy, *ends)], self.guess)
