"""Report of a calibration: tables on the terminal, and files that are written all or none."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...measure.readout import flattened
from ...models.parameters import FACTORS
from ...report.files import files_in, filled_at_once, write_json, write_rows, write_text
from ...report.files import table as in_columns
from ...safe_text import escaped
from ...scene.scene_files import scene_text
from ...sweeps.output_files import replacing
from .estimates import HEADER
from .explanations import assumptions, readings_of
from .residual_chart import draw_residuals
from .sheet_intervals import MISMATCH, RATIO

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from ..run import Calibration
    from .estimates import FittedQuantity

NUMBERS = "calibration.json"
WRITTEN = ("calibrated.toml", NUMBERS, "quantities.csv", "parameters.csv")
WRITTEN += ("correlation.csv", "residuals-*")
"""Name patterns of the written files."""
COLUMNS = ("quantity", "unit", "scene", "fitted", "low_95", "high_95", "told_by")
PARAMETER_COLUMNS = ("parameter", "counted", "value", "standard_error")
PARAMETER_COLUMNS += ("low_95", "high_95", "told_by")
BY = {True: "data", False: "prior"}
WIDEST = 1000
"""Widest console, in characters."""
LONGEST = 60
"""Letters of an interface's name in a file name, which has at most 255 bytes."""


def write_report(
    calibration: Calibration, source: str, folder: Path, ending: str = ".png"
) -> Sequence[str]:
    """Writes all files of a calibration into a folder and returns their names.

    source: names of the fitted files. ending: of the charts.
    """
    with filled_at_once(folder) as made:
        write_text(made / "calibrated.toml", calibrated_text(calibration, source))
        write_json(made / NUMBERS, numbers(calibration, source))
        write_rows(made / "quantities.csv", COLUMNS, map(_row, calibration.quantities))
        write_rows(made / "parameters.csv", PARAMETER_COLUMNS, _parameter_rows(calibration))
        names = "parameter", *_names(calibration)
        write_rows(made / "correlation.csv", names, _correlation_rows(calibration))
        interfaces = calibration.fit.spec.measurements.parts.setup.interfaces
        for k, name in enumerate(_file_names([each.name for each in interfaces])):
            draw_residuals(calibration, k, made / f"residuals-{name}{ending}")
        return files_in(made)


def write_remarks(calibration: Calibration, source: str, folder: Path) -> None:
    """Writes the numbers and remarks of a report anew, once trials have added theirs."""
    with replacing():
        write_json(folder / NUMBERS, numbers(calibration, source))


def calibrated_text(calibration: Calibration, source: str) -> str:
    """The calibrated scene as TOML, with the fitted quantities in a comment above it."""
    scene = calibration.scene
    description = "; ".join(filter(None, (scene.description, f"calibrated to {source}")))
    lines = [
        f"Calibrated to {source} by rcskin calibrate.",
        "Fitted quantities with marginal 95 % intervals:",
        *(f"  {_sentence(each)}" for each in calibration.quantities),
        *assumptions(calibration),
    ]
    comment = "".join(f"# {escaped(line)}\n" for line in lines)
    return f"{comment}\n{scene_text(scene.model_copy(update={'description': description}))}"


def table(calibration: Calibration) -> Table:
    """Table of all fitted quantities."""
    from rich.table import Column, Table

    left = [Column(name, no_wrap=True) for name in HEADER[:2]]
    right = [Column(name, justify="right", no_wrap=True) for name in HEADER[2:-1]]
    found = Table(*left, *right, HEADER[-1], box=None, padding=(0, 1, 0, 0))
    for each in calibration.quantities:
        found.add_row(*each.cells)
    return found


def correlations(calibration: Calibration, console: Console) -> Table | str:
    """Table of correlations, or the file that has them where the console is too narrow."""
    from rich.measure import Measurement

    heads = ["correlation", *(str(k + 1) for k in range(len(_names(calibration))))]
    rows = (
        [f"{k + 1} {name}", *(f"{float(each):.2f}" for each in row[: k + 1])]
        for k, (name, *row) in enumerate(_correlation_rows(calibration))
    )
    found = in_columns(heads, rows, range(1, len(heads)))
    room = console.options.update(max_width=WIDEST)
    if Measurement.get(console, room, found).minimum <= console.width:
        return found
    return f"correlations of {len(_names(calibration))} parameters are in correlation.csv"


def numbers(calibration: Calibration, source: str) -> dict[str, Any]:
    """All results, for JSON."""
    fit, noise = calibration.fit, calibration.noise
    flat = flattened(noise.readout, *readings_of(fit.spec))
    readings = zip(fit.spec.measurements.sweeps, calibration.strengths, strict=True)
    ideal = calibration.ideal
    return {
        "measured": source,
        "scene": fit.spec.measurements.parts.skin.name,
        "values": calibration.values,
        "intervals_95": calibration.intervals,
        "standard_errors": calibration.standard_errors,
        "told": calibration.identified,
        "quantities": [_quantity_row(each) for each in calibration.quantities],
        "correlation": {
            name: list(map(float, row)) for name, *row in _correlation_rows(calibration)
        },
        "strengths": [
            {"press": str(reading.press), "session": reading.session, "rises": rises.tolist()}
            for reading, rises in readings
            if reading.press.touches
        ],
        "chi_squared_per_freedom": calibration.chi_squared,
        "rms_relative_error": calibration.rms_error,
        "noise": {
            "magnitude": flat.magnitude_noise,
            "phase_rad": flat.phase_noise,
            "source": noise.source,
            "degrees_of_freedom": None if fit.spec.tail is None else fit.spec.tail.freedom,
        },
        "certificate": fit.certificate,
        "held": list(calibration.not_fitted),
        "unclear": list(calibration.unclear),
        "remarks": list(calibration.remarks),
        "ideal_capacitance": None
        if ideal is None
        else {"rms_relative_error": ideal.ideal_rms_error, "why_not": list(ideal.sentences)},
    }


def _quantity_row(each: FittedQuantity) -> dict[str, Any]:
    """A quantity by the keys of the file."""
    return {"told" if key == "identified" else key: value for key, value in asdict(each).items()}


def _names(calibration: Calibration) -> tuple[str, ...]:
    return calibration.information.names


def _row(each: FittedQuantity) -> tuple[object, ...]:
    return each.name, each.unit, each.start, each.value, each.low, each.high, each.source


def _parameter_rows(calibration: Calibration) -> Iterable[tuple[object, ...]]:
    for name, (low, high) in calibration.intervals.items():
        counted = "logarithm of a factor" if name in FACTORS else "as it is"
        value, error = calibration.values[name], calibration.standard_errors[name]
        yield name, counted, value, error, low, high, BY[calibration.identified[name]]


def _correlation_rows(calibration: Calibration) -> list[tuple[Any, ...]]:
    rows = calibration.information.correlation.tolist()
    return [(name, *row) for name, row in zip(_names(calibration), rows, strict=True)]


def _sentence(each: FittedQuantity) -> str:
    low, high = f"{each.low:.6g}", f"{each.high:.6g}"
    value = f"{each.value:.6g} {each.unit}".strip()
    return f"{each.name}: {value} ({low} to {high}), {_by(each)}, was {each.start:.6g}"


def _by(each: FittedQuantity) -> str:
    if each.identified:
        return "identified by the data"
    if each.name == RATIO:
        return "not identified by the data; assumed from the scene, within its prior"
    if MISMATCH in each.parameters:
        return f"identified by the data only together with {RATIO}, which is assumed"
    return "not identified by the data; prior kept"


def _file_names(interfaces: Sequence[str]) -> list[str]:
    """Parts of file names, distinct also where file names ignore case."""
    named = [re.sub(r"[^\w-]", "-", each)[:LONGEST] for each in interfaces]
    distinct = len({each.casefold() for each in named}) == len(named)
    return named if distinct else [f"{k}-{each}" for k, each in enumerate(named, 1)]
