"""How well do models follow measured RC lines, and do fitted values agree with published ones?

The sweeps are of porous electrodes against a blocking electrolyte: each is an RC line, open at its
end, behind a series resistance and an inductance. Every sweep is imported, checked and fitted
unattended, from one scene. `check` judges a sweep before any fit. The files lie beside the project,
in `../shared/data`; without them nothing is fitted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from rcskin.benchmarks.bench import HERE, Run, launch
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.estimates import FittedQuantity
from rcskin.simulator.calibration.run import Calibration, calibrate
from rcskin.simulator.calibration.student import FAR_OFF
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.scene.frequency import REFERENCE
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps.examination import examine
from rcskin.simulator.sweeps.imports import Defaults, import_file

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

NAME = "lines"
DATA = HERE.parents[1] / "shared" / "data"
PUBLISHED = "published_fits.csv"
SIDE, SHEET, CAPACITANCE = 0.1, 50.0, 0.3
"""m, ohm/sq, F/m²: the line to begin with has 100 ohm and 3 mF."""
LEADS = ("lead_resistance", "lead_inductance")
IDEAL_LINE = ("sheet_resistance", "capacitance", *LEADS)
CONSTANT_PHASE = (*IDEAL_LINE, "phase_exponent")
MODELS: Mapping[str, Options] = {
    "lumped": Options(fit=("capacitance", *LEADS), fix=("others",), robust=False),
    "ideal line": Options(fit=IDEAL_LINE, fix=("others",), robust=False),
    "constant phase": Options(fit=CONSTANT_PHASE, fix=("others",), robust=False),
    "best": Options(),
}
"""Fits of every sweep: three by least squares, and that of `rcskin calibrate` without options."""
NESTED = ("lumped", "ideal line", "constant phase")
"""Each has what the one before has, and leaves no more of the squares."""
TICKS = (2, 5, 10, 20, 50)
"""% on the axis of residuals."""
RESISTANCE_TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10)
MARGIN = 1.1
EXPECTED = {"Im Z <= 0"}
"""Law that every sweep breaks where its leads are inductive."""


@dataclass(frozen=True)
class Fitted:
    """A sweep with its fits by model. broken: laws that it breaks beyond EXPECTED."""

    name: str
    broken: tuple[str, ...]
    fits: Mapping[str, Calibration]
    published: Mapping[str, float]

    def rms(self, model: str) -> float:
        """Rms error of Z over |Z|, %."""
        return 100 * self.fits[model].rms_error

    def quantity(self, name: str, model: str = "constant phase") -> FittedQuantity:
        """A fitted quantity with its interval."""
        return next(each for each in self.fits[model].quantities if each.name == name)

    @property
    def far_off(self) -> int:
        """Readings that the fit with Student's t errors calls far off; 0 with normal errors."""
        fit = self.fits["best"].fit
        squares = fit.problem.squares(fit.u)
        return int((squares > FAR_OFF).sum()) if fit.spec.tail else 0

    @property
    def charge(self) -> float:
        """q of a capacitance q s^gamma, F s^(gamma - 1)."""
        c = self.quantity("foam capacitance").value * SIDE**2
        return c * (2 * np.pi * REFERENCE) ** (1 - self.quantity("phase_exponent").value)


def main(run: Run) -> int:
    """Residuals and parameters of every sweep, then of all."""
    if not DATA.is_dir():
        print(f"measured sweeps are not beside the project ({DATA}): nothing was fitted")
        return 0
    published = pd.read_csv(DATA / "lines" / PUBLISHED, index_col="file")
    files = [*sorted((DATA / "lines").glob("test_*.csv")), DATA / "blocking_line_eis.csv"]
    every = [_fitted(file, published) for file in run.sized(files, files[:2])]
    rows = [*map(_row, every), *_medians(every)]
    title = (
        "Measured RC lines: residuals of models, and fitted values (from, to) beside published ones"
    )
    run.publish(NAME, title, pd.DataFrame(rows).fillna(""))
    draw(every, run.results / f"{NAME}.png")
    left = [np.median([each.rms(model) for each in every]) for model in NESTED]
    return int(left != sorted(left, reverse=True))


def line_scene() -> Scene:
    """A line of one pixel between the left edges of two square sheets."""
    foils = {"high": "top", "low": "bottom"}
    return Scene.model_validate(
        {
            "name": "line",
            "plausible": False,
            "skin": {
                "length": SIDE,
                "width": SIDE,
                "top": {"sheet_resistance": SHEET},
                "bottom": {"sheet_resistance": SHEET},
                "foam": {"capacitance_per_area": CAPACITANCE},
            },
            "contact": [
                {"name": name, "electrode": sheet, "edge": "left"} for name, sheet in foils.items()
            ],
            "interface": [{"name": "meter", "high": ["high"], "low": ["low"]}],
            "pixels": {"rows": 1, "columns": 1},
            "sweep": {"frequencies": [1.0, 1000.0]},
        }
    )


def _fitted(file: Path, published: pd.DataFrame) -> Fitted:
    sweeps = import_file(file, Defaults(press="none"))
    scene = line_scene()
    lumped = scene.with_({"skin.sheet_resistance": 1e-3})
    own = {
        model: calibrate(lumped if model == "lumped" else scene, sweeps, options, trials=False)
        for model, options in MODELS.items()
    }
    known = published.loc[file.name].to_dict() if file.name in published.index else {}
    return Fitted(file.stem, _broken(sweeps), own, known)


def _broken(sweeps: xr.Dataset) -> tuple[str, ...]:
    """Laws of passive networks that a sweep breaks below its inductive end."""
    return tuple(each.law for each in examine(sweeps)[0].broken if each.law not in EXPECTED)


def _row(each: Fitted) -> dict[str, str]:
    beside = {
        "resistance, ohm": ("both in series", "r_ion_ohm"),
        "exponent": ("phase_exponent", "gamma"),
        "in series, ohm": ("lead_resistance", "r_sep_ohm"),
    }
    row = {"sweep": each.name, "check": "; ".join(each.broken) or "passes"}
    row |= {f"{model}, rms %": f"{each.rms(model):.2f}" for model in MODELS}
    for head, (name, key) in beside.items():
        found = each.quantity(name)
        row[head] = f"{found.value:.4g} ({found.low:.4g}, {found.high:.4g})"
        row[f"published {head.partition(',')[0]}"] = (
            f"{each.published[key]:.4g}" if each.published else ""
        )
    row["q"] = f"{each.charge:.3g}"
    row["published q"] = f"{each.published['q_s']:.3g}" if each.published else ""
    row["far off"] = str(each.far_off)
    return row


def _medians(every: list[Fitted]) -> Iterator[dict[str, str]]:
    passing = [each for each in every if not each.broken]
    for name, group in (("median of all", every), ("median of those that pass", passing)):
        row = {"sweep": name, "check": f"{len(group)} sweeps"}
        for model in MODELS:
            row[f"{model}, rms %"] = f"{np.median([each.rms(model) for each in group]):.2f}"
        off = [abs(each) for each in map(_resistance_off, group) if each is not None]
        row["resistance, ohm"] = f"{np.median(off):.1f} % off the published, at most {max(off):.1f}"
        yield row


def _resistance_off(each: Fitted) -> float | None:
    """Difference from the published resistance, %."""
    if not each.published:
        return None
    return 100 * (each.quantity("both in series").value / each.published["r_ion_ohm"] - 1)


def draw(every: list[Fitted], path: Path) -> None:
    """Residuals of each model, and resistances over published ones with their intervals."""
    with chart(path, 9, 4.6) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        labels = [each.name.removeprefix("test_data_").partition("_eis")[0] for each in every]
        left.set_yticks(range(len(every)), labels)
        left.set_ylim(len(every) - 0.5, -0.5)
        for model, colour in zip(MODELS, COLOURS, strict=False):
            left.plot([each.rms(model) for each in every], range(len(every)), "o", color=colour)
            left.plot([], [], "o", color=colour, label=model)
        left.set_xscale("log")
        left.set_xticks(TICKS, list(map(str, TICKS)))
        left.set_xticks([], minor=True)
        left.set_xlabel("rms error of Z over |Z| (%)")
        left.set_ylabel("sweep")
        _draw_resistances(right, every)
        for axes in (left, right):
            for k, each in enumerate(every):
                if each.broken:
                    axes.axhspan(k - 0.5, k + 0.5, color="0.9", zorder=0)
            axes.axhspan(-2, -1.9, color="0.9", label="breaks a law (check)")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
        figure.suptitle("Measured RC lines: residuals of models, and the resistance of the line")


def _draw_resistances(axes: Axes, every: list[Fitted]) -> None:
    axes.axvline(1, color="0.6", linewidth=1)
    for k, each in enumerate(every):
        if each.published:
            low, value, high = resistance_over_published(each)
            ends = [[value - low], [high - value]]
            axes.errorbar(value, k, xerr=ends, fmt="o", color=COLOURS[2])
    axes.set_xscale("log")
    axes.set_xticks(RESISTANCE_TICKS, list(map(str, RESISTANCE_TICKS)))
    axes.set_xticks([], minor=True)
    axes.set_xlim(resistance_range(every))
    axes.set_xlabel("resistance over the published one, 95 % interval")


def resistance_over_published(each: Fitted) -> tuple[float, float, float]:
    """Lower end, value and upper end of the resistance's interval over the published value."""
    found, known = each.quantity("both in series"), each.published["r_ion_ohm"]
    return found.low / known, found.value / known, found.high / known


def resistance_range(every: list[Fitted]) -> tuple[float, float]:
    """Range that shows the interval of every sweep that passes the check, with a margin."""
    shown = [resistance_over_published(each) for each in every if each.published]
    passing = [resistance_over_published(e) for e in every if e.published and not e.broken]
    ends = np.array(passing or shown or [(0.5, 1, 2)])
    return float(ends.min()) / MARGIN, float(ends.max()) * MARGIN


if __name__ == "__main__":
    launch(main)
