"""The report: one HTML file with every number and every picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...simulator.models.solver import DEFAULT_RTOL
from ...simulator.report.page import Cell, Items, ReportSection, TableGrid, write_page
from .claims import RULES, Claim
from .studies import DRAWS

PAPER = (
    "H. A. Sonar, M. C. Yuen, R. Kramer-Bottiglio, J. Paik, “An Any-Resolution Distributed "
    "Pressure Localization Scheme Using a Capacitive Soft Sensor Skin”"
)
ASSUMED = (
    "The paper states neither the meter's noise nor how equal its presses were. The scenes assume "
    "the noise that is given with each number; the chart of accuracy against noise shows what that "
    "choice does. Each experiment is one draw of six presses a pixel, as in the paper; the studies "
    f"are means of {DRAWS} draws of the noise."
)


def write_report(
    path: Path, claims: Sequence[Claim], pictures: Sequence[ReportSection], software: str
) -> None:
    """Write the page completely or not at all. software: name and version of the simulator."""
    introduction = (
        f"{PAPER}. Every sweep below is simulated: the two electrode sheets and the foam as a "
        f"distributed RC sheet, solved to a relative tolerance of {DEFAULT_RTOL:g} of Rs and of "
        f"Cp, then read out by a meter with the noise of the scene. {software}."
    )
    sections = [ReportSection("", [introduction]), _compared(claims), *pictures]
    sections.append(ReportSection("What is assumed", [ASSUMED]))
    write_page(path, "The paper, reproduced by physics", sections)


def _compared(claims: Sequence[Claim]) -> ReportSection:
    """Table of all statements and our results; those that differ come first."""
    agreeing = sum(claim.agrees for claim in claims)
    introduction = (
        f"{agreeing} of {len(claims)} statements agree; those that differ stand first. Each is "
        "judged on the device as the paper describes it, foils included, at the noise that is "
        "given with it. A statement agrees, by the rule that is given with it, if"
    )
    rules = Items([f"{rule}." for rule in RULES.values()], list(RULES))
    rows = [_row(claim) for claim in sorted(claims, key=lambda claim: claim.agrees)]
    grid = TableGrid(["Statement", "Paper", "Simulation", "Noise", "", "Why"], rows)
    return ReportSection("Every number of the paper next to ours", [introduction, rules, grid])


def _row(claim: Claim) -> list[str | Cell]:
    verdict = "✓ agrees" if claim.agrees else "✗ differs"
    return [
        Cell(claim.topic, claim.source),
        claim.paper,
        claim.ours,
        claim.noise,
        Cell(verdict, claim.rule, claim.agrees),
        claim.why,
    ]
