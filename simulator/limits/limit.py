"""Best accuracy of any classifier, as a result for scripts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..safe_text import Tabular


@dataclass(frozen=True, repr=False)
class Limit(Tabular):
    """Accuracy of the best classifier of a `target`, and its standard error.

    Unpacks into these two numbers.
    """

    target: str
    accuracy: float
    standard_error: float

    def __iter__(self) -> Iterator[float]:
        return iter((self.accuracy, self.standard_error))

    def _table(self) -> tuple[str, list[tuple[str, str]]]:
        numbers = f"{self.accuracy:.4f}", f"{self.standard_error:.4f}"
        return f"Limit of {self.target}", [("accuracy", "standard_error"), numbers]
