"""Report of a check: a table on the terminal, a chart, and CSV files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..chart_style import COLOURS, ENDINGS, chart, frequency_axis
from ..report.files import filled_at_once, table, write_rows
from ..sweeps import InputError, checked_folder, checked_output
from ..sweeps.examination import Verdict

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure
    from rich.table import Table

PASSING, UNNAMED = "0.6", "0.3"
BANDS = {"allowed": "0.93", "allowed where the misfit is too large": "0.8"}
PARTS = {"real": "Real part", "imag": "Imaginary part"}


class ColouredVerdict(NamedTuple):
    """A verdict and the colour in which it is drawn."""

    verdict: Verdict
    colour: str


def draw_residuals(verdicts: Sequence[Verdict], path: Path) -> None:
    """Draws residuals from the nearest passive network over frequency, and broken laws.

    A row for each interface: real and imaginary part. Grey: sweeps that pass. Coloured: sweeps that
    break a law. Shaded: the limits; crosses: residuals beyond them. Inductive readings have no
    residual. Below: a cross for each law at each frequency where a sweep breaks it.
    """
    interfaces = list(dict.fromkeys(each.interface for each in verdicts))
    laws = list(dict.fromkeys(law.law for each in verdicts for law in each.broken))
    drawn = _coloured(verdicts)
    heights = [3.4 * len(interfaces), *([0.9 + 0.3 * len(laws)] if laws else [])]
    with chart(path, 9, 0.9 + sum(heights)) as figure:
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        _draw_rows(parts[0], interfaces, drawn)
        if laws:
            _draw_laws(parts[1], laws, drawn)
        handles, labels = _legend(parts[0].axes[0], drawn)
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
        flagged = sum(bool(each.broken) for each in verdicts)
        figure.suptitle(f"{flagged} of {len(verdicts)} spectra break a law")


def _coloured(verdicts: Sequence[Verdict]) -> list[ColouredVerdict]:
    """Assigns a colour to each verdict that breaks a law, as long as colours last."""
    shades = iter(COLOURS)
    return [
        ColouredVerdict(each, next(shades, UNNAMED) if each.broken else PASSING)
        for each in verdicts
    ]


def _draw_rows(
    figure: SubFigure, interfaces: Sequence[str], drawn: Sequence[ColouredVerdict]
) -> None:
    rows = figure.subplots(len(interfaces), 2, squeeze=False, sharex=True, sharey="row")
    for row, interface in zip(rows, interfaces, strict=True):
        own = [each for each in drawn if each.verdict.interface == interface]
        for axes, part in zip(row, PARTS, strict=True):
            axes.set_title(f"{PARTS[part]}, {interface}")
            _draw_bands(axes, own)
            for each in own:
                _draw_residual(axes, part, each)
        row[0].set_ylabel("(Z - nearest passive\nnetwork) / |Z| (%)")
    for axes in rows[-1]:
        frequency_axis(axes)


def _draw_bands(axes: Axes, own: Sequence[ColouredVerdict]) -> None:
    """Shades the limits: equal for a whole interface, narrower if the misfit is too large."""
    kHz = own[0].verdict.spectrum.frequency / 1e3
    bands = {each.verdict.allowed.tobytes(): 100 * each.verdict.allowed for each in own}
    widest_first = sorted(bands.values(), key=np.sum, reverse=True)
    for (name, shade), band in zip(BANDS.items(), widest_first, strict=False):
        axes.fill_between(kHz, -band, band, color=shade, zorder=0, label=name)


def _draw_residual(axes: Axes, part: str, drawn: ColouredVerdict) -> None:
    verdict, colour = drawn
    kept, kHz = ~verdict.spectrum.inductive, verdict.spectrum.frequency / 1e3
    residual = 100 * getattr(verdict.spectrum.residual, part)
    beyond = kept & (np.abs(residual) > 100 * verdict.allowed)
    axes.plot(kHz[kept], residual[kept], marker=".", color=colour)
    axes.plot(kHz[beyond], residual[beyond], "x", color=colour, markersize=8)


def _draw_laws(figure: SubFigure, laws: Sequence[str], drawn: Sequence[ColouredVerdict]) -> None:
    """Draws a line for each law; sweeps that break it are offset vertically."""
    broken = [each for each in drawn if each.verdict.broken]
    axes = figure.subplots()
    for number, (verdict, colour) in enumerate(broken):
        offset = 0.5 * (number + 0.5) / len(broken) - 0.25
        for law in verdict.broken:
            height = np.full(len(law.frequency), laws.index(law.law) + offset)
            axes.plot(np.array(law.frequency) / 1e3, height, "x", color=colour)
    kHz = np.concatenate([each.verdict.spectrum.frequency for each in drawn]) / 1e3
    frequency_axis(axes)
    axes.set_xlim(kHz.min() / 1.1, kHz.max() * 1.1)
    axes.set_yticks(range(len(laws)), laws)
    axes.set_ylim(len(laws) - 0.5, -0.5)
    axes.set_title("Broken laws: a cross at each frequency")


def _legend(axes: Axes, drawn: Sequence[ColouredVerdict]) -> tuple[list[Artist], list[str]]:
    """Legend: the limits, passing sweeps, sweeps that break a law, and uncoloured ones."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    named = {
        f"sweep {each.verdict.sweep}, {each.verdict.interface}": each.colour
        for each in drawn
        if each.verdict.broken and each.colour != UNNAMED
    }
    unnamed = sum(each.colour == UNNAMED for each in drawn)
    passing = {"passes": PASSING} if not all(each.verdict.broken for each in drawn) else {}
    further = {f"{unnamed} more that break a law": UNNAMED} if unnamed else {}
    entries = passing | named | further
    lines = [Line2D([], [], color=colour, marker=".") for colour in entries.values()]
    return [*handles, *lines], [*labels, *entries]


SUMMARY = "sweep press interface lowest_phase_deg highest_phase_deg noise noise_from misfit".split()
SUMMARY += ["inductance_H", "broken"]
RESIDUALS = "sweep interface frequency_Hz residual_real residual_imag allowed fitted broken".split()

WRITTEN = ("residuals.png", "verdicts.csv", "residuals.csv")
"""Names of the files of a report."""


def checked_report(path: Path) -> Path:
    """Returns the path if a report can be written there: a chart or a folder.

    Raises InputError for another ending or a missing folder.
    """
    if path.is_dir() or not path.suffix:
        return checked_folder(path, *WRITTEN)
    if path.suffix not in ENDINGS:
        endings = ", ".join(ENDINGS)
        raise InputError(f"{path}: must end in {endings} or be a folder, got {path.suffix!r}")
    return checked_output(path, ENDINGS)


def write_report(verdicts: Sequence[Verdict], path: Path) -> None:
    """Writes the residual chart; in a folder also tables of all verdicts and residuals."""
    if path.suffix in ENDINGS and not path.is_dir():
        draw_residuals(verdicts, path)
        return
    rows = (row for verdict in verdicts for row in _readings(verdict))
    with filled_at_once(path) as folder:
        draw_residuals(verdicts, folder / "residuals.png")
        write_rows(folder / "verdicts.csv", SUMMARY, map(_summary, verdicts))
        write_rows(folder / "residuals.csv", RESIDUALS, rows)


def verdict_table(verdicts: Sequence[Verdict]) -> Table:
    """Table with one line for every sweep at every interface."""
    heads = ["sweep", "press", "interface", "phase (deg)", "noise", "misfit", "verdict"]
    rows = (
        [
            str(each.sweep),
            each.press,
            each.interface,
            f"{each.phase[0]:.1f} to {each.phase[1]:.1f}",
            f"{100 * np.median(each.noise):.2g} %",
            f"{100 * each.spectrum.misfit:.2g} %",
            _verdict(len(each.broken)),
        ]
        for each in verdicts
    )
    return table(heads, rows, (3, 4, 5))


def _verdict(broken: int) -> str:
    return f"{broken} law{'s' if broken > 1 else ''} broken" if broken else "pass"


def explanations(verdicts: Iterable[Verdict]) -> list[str]:
    """One line for every broken law, and for every inductance that was excluded."""
    return [
        line for each in verdicts for line in [*map(str, each.broken), *_excluded_inductance(each)]
    ]


def _excluded_inductance(verdict: Verdict) -> list[str]:
    spectrum = verdict.spectrum
    if not spectrum.inductive.any():
        return []
    onset, inductance = spectrum.frequency[spectrum.inductive][0], spectrum.inductance
    behind = f"behind {inductance:.2g} H in series" if inductance else "by themselves"
    return [
        f"sweep {verdict.sweep}, interface {verdict.interface}: inductive from {onset:.6g} Hz "
        f"on; the readings below were checked {behind}"
    ]


def _summary(verdict: Verdict) -> list[object]:
    spectrum = verdict.spectrum
    return [
        verdict.sweep,
        verdict.press,
        verdict.interface,
        *verdict.phase,
        float(np.median(verdict.noise)),
        verdict.noise_from,
        spectrum.misfit,
        spectrum.inductance,
        "; ".join(each.law for each in verdict.broken),
    ]


def _readings(verdict: Verdict) -> Iterable[list[object]]:
    spectrum = verdict.spectrum
    columns = (
        spectrum.frequency,
        spectrum.residual.real,
        spectrum.residual.imag,
        verdict.allowed,
        (~spectrum.inductive).astype(int),
    )
    for row in zip(*(column.tolist() for column in columns), strict=True):
        laws = [each.law for each in verdict.broken if row[0] in each.frequency]
        yield [verdict.sweep, verdict.interface, *row, "; ".join(laws)]
