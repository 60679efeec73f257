"""Report of a calibration: tables, explanations, the calibrated scene and numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Complex, Real
from ..measure.readout import flattened
from ..models.parameters import FACTORS, SOURCE
from ..report.files import write_json, write_text
from ..report.findings import Chart, DataTable, Findings, Head
from ..safe_text import escaped
from ..scene.scene_files import scene_text
from ..sweeps.output_files import replacing
from .residual_chart import draw_residuals, small_residual_chart
from .sheet_intervals import MISMATCH, RATIO

if TYPE_CHECKING:
    from .estimates import FittedQuantity
    from .fit_options import FitSpec
    from .identifiability import Information
    from .run import Calibration

NUMBERS = "calibration.json"
WRITTEN = ("calibrated.toml", NUMBERS, "quantities.csv", "parameters.csv")
WRITTEN += ("correlation.csv", "residuals-*")
"""Name patterns of the written files."""
COLUMNS = ["quantity", "unit", Head("scene", form=".4g"), Head("fitted", form=".4g")]
COLUMNS += [Head("low_95", "from", ".4g"), Head("high_95", "to", ".4g"), "source"]
ALL = 1000
"""Largest number of rows of a table that a terminal shows."""
PARAMETER_COLUMNS = ("parameter", "counted", "value", "standard_error")
PARAMETER_COLUMNS += ("low_95", "high_95", "source")
BY = {True: "data", False: "prior"}
LONGEST = 60
"""Letters of an interface's name in a file name, which has at most 255 bytes."""


def report_of(calibration: Calibration, source: str) -> Findings:
    """Tables, remarks, charts and numbers of a calibration. source: names of the fitted files."""
    text = calibrated_text(calibration, source)
    rows = _correlation_rows(calibration)
    files = {"calibrated.toml": partial(write_text, text=text)}
    return Findings(
        f"Calibration of {calibration.scene.name}",
        [
            DataTable("quantities", COLUMNS, [*map(_row, calibration.quantities)], ALL, csv=True),
            *_correlations(rows),
            *explanations(calibration),
            DataTable(
                "parameters", PARAMETER_COLUMNS, [*_parameter_rows(calibration)], 0, csv=True
            ),
            DataTable("correlation", ("parameter", *_names(calibration)), rows, 0, csv=True),
            *_charts(calibration),
        ],
        numbers=numbers(calibration, source),
        files=files,
        small=lambda: small_residual_chart(calibration),
    )


def _charts(calibration: Calibration) -> Iterator[Chart]:
    interfaces = calibration.fit.spec.measurements.parts.setup.interfaces
    for k, name in enumerate(_file_names([each.name for each in interfaces])):
        yield Chart(f"residuals-{name}", "Residuals", partial(draw_residuals, calibration, k))


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


def _correlations(rows: Sequence[Sequence[Any]]) -> Iterator[DataTable]:
    """Lower half of the correlations."""
    if len(rows) > 1:
        numbers = (Head(str(k + 1), form=".2f") for k in range(len(rows)))
        half = [
            [f"{k + 1} {name}", *row[: k + 1], *[None] * (len(rows) - k - 1)]
            for k, (name, *row) in enumerate(rows)
        ]
        wide = f"correlations of {len(rows)} parameters are in correlation.csv"
        yield DataTable("correlations", ["correlation", *numbers], half, ALL, instead=wide)


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
        "identified": calibration.identified,
        "quantities": [asdict(each) for each in calibration.quantities],
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
        "fixed": list(calibration.not_fitted),
        "unclear": list(calibration.unclear),
        "remarks": list(calibration.remarks),
        "ideal_capacitance": None
        if ideal is None
        else {"rms_relative_error": ideal.ideal_rms_error, "why_not": list(ideal.sentences)},
    }


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


TIED = 0.95
WIDENED = 1.2
"""Chi-squared per degree of freedom from which the report states that it widens intervals."""


def explanations(calibration: Calibration) -> list[str]:
    """Remarks on the fit, a line each."""
    spec = calibration.fit.spec
    readings = "gains" if spec.measurements.parts.setup.gain else "Z"
    lines = [
        f"chi-squared per degree of freedom {calibration.chi_squared:.3g}"
        f"{' by construction' if calibration.noise.guessed else ''}; "
        f"rms relative error of {readings} {100 * calibration.rms_error:.3g} %",
        f"noise from {calibration.noise.source}: {_noise(spec)}",
    ]
    lines += _widening(calibration.information)
    if spec.touch_count:
        lines.append(_strength_range(calibration))
    lines += _source(calibration)
    lines += assumptions(calibration)
    lines += _strong_correlations(calibration)
    lines += calibration.remarks
    return [*lines, *(calibration.ideal.sentences if calibration.ideal else ())]


def _noise(spec: FitSpec) -> str:
    """Noise of magnitude and phase of the measured readings, with its range where it has one."""
    noise = spec.readout.noise(*readings_of(spec))
    found = (
        " to ".join(dict.fromkeys(f"{scale * each:.3g}" for each in (own.min(), own.max())))
        for own, scale in zip(noise, (100, 1e3), strict=True)
    )
    magnitude = "|V / V_s|" if spec.measurements.parts.setup.gain else "|Z|"
    units = (f"% of {magnitude}", "mrad")[: spec.measurements.per_reading]
    return ", ".join(f"{each} {unit}" for each, unit in zip(found, units, strict=False))


def readings_of(spec: FitSpec) -> tuple[Complex, Real]:
    """Z in ohm of all readings, shape (sweep, reading), and the frequency of each, Hz."""
    read, f = spec.measurements.read, spec.measurements.parts.setup.frequency
    Z = np.stack([each.Z[read] for each in spec.measurements.sweeps])
    return Z, np.broadcast_to(f, read.shape)[read]


def _widening(information: Information) -> list[str]:
    """A line on the factor by which intervals are wider than by independent noise, and why."""
    scale, count = information.scale, information.correlated
    if scale < WIDENED:
        return []
    reasons = {
        f"exceed the noise ({(scale / count) ** 0.5:.2g} times)": scale / count,
        f"are correlated ({count**0.5:.2g} times: {count:.2g} of them count as one)": count,
    }
    why = " and ".join(reason for reason, share in reasons.items() if share > WIDENED**0.5)
    wider = f"intervals are {scale**0.5:.2g} times as wide as by the noise alone"
    return [f"{wider}, because the residuals {why}"]


def _strong_correlations(calibration: Calibration) -> list[str]:
    """A line for each pair of strongly correlated estimates."""
    names, rows = calibration.information.names, calibration.information.correlation
    return [
        f"{names[i]} and {names[j]} are strongly correlated ({rows[i, j]:+.3f})"
        for i in range(len(names))
        for j in range(i)
        if abs(rows[i, j]) > TIED
    ]


def _source(calibration: Calibration) -> list[str]:
    """A line on the voltage of the source of gains, where that is a parameter."""
    if SOURCE not in calibration.intervals:
        return []
    value, error = calibration.values[SOURCE], calibration.standard_errors[SOURCE]
    if calibration.identified[SOURCE]:
        return [f"the source has {value:.4g} times the stated voltage, standard error {error:.2g}"]
    return [
        f"the voltage of the source is not identified by these gains ({value:.3g} times the "
        f"stated one, standard error {error:.2g}); if it is known, use --fix {SOURCE}"
    ]


def _strength_range(calibration: Calibration) -> str:
    problem, nothing = calibration.fit.problem, np.zeros_like(calibration.fit.u)
    stated = [problem.strengths(nothing, k) for k in range(len(problem.cells))]
    pairs = zip(calibration.strengths, stated, strict=True)
    over = [
        float(own / stated_rise)
        for rises, stated_rises in pairs
        for own, stated_rise in zip(rises, stated_rises, strict=True)
    ]
    return (
        f"rises of {len(over)} touches are {min(over):.2f} to {max(over):.2f} times the stated ones"
    )


def assumptions(calibration: Calibration) -> list[str]:
    """Quantities that are assumed, not identified, a line each."""
    left = ", ".join(name for name in calibration.not_fitted if name != MISMATCH)
    kept = f"not fitted; scene's values kept, uncertain within their priors: {left}"
    return [*([kept] if left else []), *calibration.unclear]
