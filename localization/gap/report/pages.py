"""The report: one HTML file with every chart in it, and the numbers beside it as JSON."""

from __future__ import annotations

import json
from base64 import b64encode
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from ....simulator.shown import pages
from ....simulator.sweeps import whole_file
from .charts import charts_of
from .numbers import numbers
from .telling import cause_told, estimate_told, heads, rows_of, summary

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..findings import Findings

HTML, JSON = "gap.html", "gap.json"
TEMPLATE = "gap.html.jinja"


class Picture(NamedTuple):
    """A drawn chart: its name, what it shows, and its PNG as base64 text."""

    name: str
    caption: str
    base64: str


def write_report(folder: Path, findings: Findings, ending: str | None = None) -> None:
    """Write gap.html and gap.json, both whole or neither. ending: of charts beside them, if any."""
    figures = json.dumps(numbers(findings), indent=1, allow_nan=False) + "\n"
    page = _rendered(findings, _drawn(findings))
    with whole_file(folder / JSON) as unfinished, whole_file(folder / HTML) as unfinished_page:
        unfinished.write_text(figures, encoding="utf-8")
        unfinished_page.write_text(page, encoding="utf-8")
    for chart in charts_of(findings) if ending else ():
        chart.draw(folder / f"{chart.name}{ending}")


def _drawn(findings: Findings) -> dict[str, Picture]:
    with TemporaryDirectory() as folder:
        found = {}
        for chart in charts_of(findings):
            path = Path(folder) / f"{chart.name}.png"
            chart.draw(path)
            encoded = b64encode(path.read_bytes()).decode("ascii")
            found[chart.name] = Picture(chart.name, chart.caption, encoded)
        return found


def _rendered(findings: Findings, pictures: dict[str, Picture]) -> str:
    environment = pages(
        Path(__file__).parent, keep_trailing_newline=True, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template(TEMPLATE).render(_content(findings, pictures))


def _content(findings: Findings, pictures: dict[str, Picture]) -> dict[str, Any]:
    trial = findings.trial
    return {
        "noun": trial.pair.noun,
        "simulated": trial.pair.simulated,
        "other": trial.pair.other,
        "question": trial.question,
        "summary": summary(findings),
        "columns": heads(findings),
        "rows": rows_of(findings),
        "cause": cause_told(findings),
        "error": trial.error,
        "estimates": [estimate_told(each) for each in trial.estimates],
        "notes": findings.notes,
        "own_model": findings.model is not None,
        "sections": _sections(pictures),
    }


def _sections(pictures: dict[str, Picture]) -> Sequence[tuple[str, list[Picture]]]:
    """Headings and the pictures under them, by the names of these."""
    headings = {
        "How far apart the mean sweeps are": "distance",
        "How often the localizer is right": "accuracy",
        "What is taken for what": "confusion",
        "Whether the model's probabilities can be believed": "belief",
        "How far apart the distributions of the features are": "distribution",
        "Which parameter explains most": "causes",
    }
    found = [
        (title, [picture for name, picture in pictures.items() if name.startswith(prefix)])
        for title, prefix in headings.items()
    ]
    return [(title, shown) for title, shown in found if shown]
