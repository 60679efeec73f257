"""What a part hands back, and the page that all of them make."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

PASSED, FAILED = "pass", "**FAIL**"


@dataclass(frozen=True)
class Check:
    """One line of a table: what is asked, what is expected, what the run measured."""

    what: str
    expected: str
    measured: str
    passed: bool


@dataclass(frozen=True)
class Section:
    """One table under a heading. says: what it shows, in two sentences. chart: in `results/`."""

    title: str
    says: str
    checks: tuple[Check, ...]
    chart: str = ""

    @property
    def passed(self) -> bool:
        """Whether every line holds."""
        return all(check.passed for check in self.checks)

    def lines(self) -> Iterable[str]:
        """The section in Markdown."""
        yield from (f"### {self.title}", "", self.says, "")
        yield from ("| what | expected | measured | |", "|---|---|---|---|")
        for check in self.checks:
            verdict = PASSED if check.passed else FAILED
            yield f"| {check.what} | {check.expected} | {check.measured} | {verdict} |"
        yield ""
        if self.chart:
            yield from (f"![{self.title}]({self.chart})", "")


def below(what: str, limit: float, *measured: float) -> Check:
    """That none of some errors passes a limit."""
    stated = ", ".join(f"{error:.1e}" for error in measured)
    return Check(what, f"<= {limit:.0e}", stated, all(error <= limit for error in measured))


def slopes(what: str, expected: Iterable[float], measured: Iterable[float]) -> Check:
    """That every observed order reaches the expected one to within a tenth of it."""
    pairs = list(zip(expected, measured, strict=True))
    return Check(
        what,
        ", ".join(f"{order:g}" for order, _ in pairs),
        ", ".join(f"{slope:.2f}" for _, slope in pairs),
        all(slope > 0.9 * order for order, slope in pairs),
    )
