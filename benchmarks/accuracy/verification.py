"""Whether the equations are solved right, how well the error is known, and whether others agree.

Code verification, solution verification, cross-code comparison and the limits of the model, as
ASME V&V 10 and NAFEMS keep them apart. Writes results/verification.md; exits with 1 where a line
fails.

Run: python benchmarks/accuracy/verification.py [--quick]
"""

from __future__ import annotations

import time
from collections.abc import Callable

from rcskin.benchmarks.accuracy.checks import Section
from rcskin.benchmarks.accuracy.verification_codes import other_codes, thin_sheets
from rcskin.benchmarks.accuracy.verification_estimates import campaign, estimates
from rcskin.benchmarks.accuracy.verification_forms import (
    closed_forms,
    manufactured,
    orders,
    round_skins,
)
from rcskin.benchmarks.bench import Run, launch, machine
from rcskin.simulator.sweeps import whole_file

COMMAND = ".venv/bin/python benchmarks/accuracy/verification.py"

Chapter = tuple[str, str, tuple[Callable[[Run], Section], ...]]
CHAPTERS: tuple[Chapter, ...] = (
    (
        "Code verification",
        "Are the equations solved right? Errors against known solutions, and how they fall.",
        (
            orders,
            closed_forms,
            manufactured,
            round_skins,
        ),
    ),
    (
        "Solution verification",
        "Is the error of an answer known where no formula is? The solver's own estimate, judged.",
        (estimates, campaign),
    ),
    (
        "Cross-code comparison",
        "Do programs that share nothing with this one say the same?",
        (other_codes,),
    ),
    (
        "Limits of the model",
        "Where do the right equations end? What two sheets without thickness leave out. Whether a "
        "skin that is built behaves so is validation, and needs measurements.",
        (thin_sheets,),
    ),
)


def main(run: Run) -> int:
    """Run every chapter, write the page, and say whether all passed."""
    start = time.perf_counter()
    chapters = [
        (title, says, [printed(each(run)) for each in parts]) for title, says, parts in CHAPTERS
    ]
    sections = [section for *_, found in chapters for section in found]
    checks = [check for section in sections for check in section.checks]
    failed = [check for check in checks if not check.passed]
    verdict = f"{len(checks) - len(failed)} of {len(checks)} checks pass."
    lines = ["# Verification", "", f"{verdict} Measured by `{COMMAND}` on", f"{machine()}.", ""]
    for title, says, found in chapters:
        lines += [f"## {title}", "", says, ""]
        lines += [line for section in found for line in section.lines()]
    with whole_file(run.results / "verification.md") as unfinished:
        unfinished.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(f"{verdict} {time.perf_counter() - start:.0f} s")
    return 1 if failed else 0


def printed(section: Section) -> Section:
    """The same section, printed as soon as it is there."""
    print("\n".join(section.lines()), flush=True)
    return section


if __name__ == "__main__":
    launch(main)
