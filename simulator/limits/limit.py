"""Best accuracy of any classifier, as a result for scripts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..report.findings import DataTable, Findings, Head, Rate, Result, rate_bars

NORMAL = 1.96
"""Half of a 95 % interval, in standard errors."""


@dataclass(frozen=True, repr=False)
class Limit(Result):
    """Accuracy of the best classifier of a `target`, and its standard error.

    Unpacks into these two numbers. guess: accuracy of the best guess without a sweep.
    """

    target: str
    accuracy: float
    standard_error: float
    guess: float

    def __iter__(self) -> Iterator[float]:
        return iter((self.accuracy, self.standard_error))

    @property
    def report(self) -> Findings:
        """Accuracy, standard error and guess."""
        numbers, off = (*self, self.guess), NORMAL * self.standard_error
        header = [Head(k, form=".4f") for k in ("accuracy", "standard_error", "guess")]
        ends = max(self.accuracy - off, 0.0), min(self.accuracy + off, 1.0)
        best = Rate("best classifier", self.accuracy, *ends)
        table, chart = DataTable("limit", header, [numbers]), rate_bars([best], self.guess)
        return Findings(f"Limit of {self.target}", [table], small=lambda: chart)
