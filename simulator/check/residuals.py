"""The chart of a check: residuals beside what is allowed of them, and every broken law."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..chart_style import COLOURS, chart, frequency_axis
from ..sweeps.laws.examination import Verdict

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

PASSING, UNNAMED = "0.6", "0.3"
BANDS = {"allowed": "0.93", "allowed where the misfit is too large": "0.8"}
PARTS = {"real": "Real part", "imag": "Imaginary part"}


class ColouredVerdict(NamedTuple):
    """A judgement and the colour it is drawn in."""

    judgement: Verdict
    colour: str


def draw_residuals(judgements: Sequence[Verdict], path: Path) -> None:
    """Residual of the nearest passive network against frequency, and where laws are broken.

    A row for each interface: real and imaginary part. Grey: sweeps that pass. Coloured: sweeps that
    break a law. Shaded: what is allowed; crosses: what is beyond. Inductive readings have no
    residual. Below them a mark for each law at each frequency where a sweep breaks it.
    """
    interfaces = list(dict.fromkeys(each.interface for each in judgements))
    laws = list(dict.fromkeys(law.law for each in judgements for law in each.broken))
    drawn = _coloured(judgements)
    heights = [3.4 * len(interfaces), *([0.9 + 0.3 * len(laws)] if laws else [])]
    with chart(path, 9, 0.9 + sum(heights)) as figure:
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        _draw_rows(parts[0], interfaces, drawn)
        if laws:
            _draw_laws(parts[1], laws, drawn)
        handles, labels = _legend(parts[0].axes[0], drawn)
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
        flagged = sum(bool(each.broken) for each in judgements)
        figure.suptitle(f"{flagged} of {len(judgements)} spectra break a law")


def _coloured(judgements: Sequence[Verdict]) -> list[ColouredVerdict]:
    """Those that break a law in colours of their own, as far as there are such."""
    shades = iter(COLOURS)
    return [
        ColouredVerdict(each, next(shades, UNNAMED) if each.broken else PASSING)
        for each in judgements
    ]


def _draw_rows(
    figure: SubFigure, interfaces: Sequence[str], drawn: Sequence[ColouredVerdict]
) -> None:
    rows = figure.subplots(len(interfaces), 2, squeeze=False, sharex=True, sharey="row")
    for row, interface in zip(rows, interfaces, strict=True):
        own = [each for each in drawn if each.judgement.interface == interface]
        for axes, part in zip(row, PARTS, strict=True):
            axes.set_title(f"{PARTS[part]}, {interface}")
            _draw_bands(axes, own)
            for each in own:
                _draw_residual(axes, part, each)
        row[0].set_ylabel("(Z - nearest passive\nnetwork) / |Z| (%)")
    for axes in rows[-1]:
        frequency_axis(axes)


def _draw_bands(axes: Axes, own: Sequence[ColouredVerdict]) -> None:
    """What is allowed: alike for a whole interface, but less where the misfit is too large."""
    kHz = own[0].judgement.spectrum.frequency / 1e3
    bands = {each.judgement.allowed.tobytes(): 100 * each.judgement.allowed for each in own}
    widest_first = sorted(bands.values(), key=np.sum, reverse=True)
    for (name, shade), band in zip(BANDS.items(), widest_first, strict=False):
        axes.fill_between(kHz, -band, band, color=shade, zorder=0, label=name)


def _draw_residual(axes: Axes, part: str, drawn: ColouredVerdict) -> None:
    judgement, colour = drawn
    kept, kHz = ~judgement.spectrum.inductive, judgement.spectrum.frequency / 1e3
    residual = 100 * getattr(judgement.spectrum.residual, part)
    beyond = kept & (np.abs(residual) > 100 * judgement.allowed)
    axes.plot(kHz[kept], residual[kept], marker=".", color=colour)
    axes.plot(kHz[beyond], residual[beyond], "x", color=colour, markersize=8)


def _draw_laws(figure: SubFigure, laws: Sequence[str], drawn: Sequence[ColouredVerdict]) -> None:
    """A line for each law; sweeps that break it stand a little above each other."""
    broken = [each for each in drawn if each.judgement.broken]
    axes = figure.subplots()
    for number, (judgement, colour) in enumerate(broken):
        offset = 0.5 * (number + 0.5) / len(broken) - 0.25
        for law in judgement.broken:
            height = np.full(len(law.frequency), laws.index(law.law) + offset)
            axes.plot(np.array(law.frequency) / 1e3, height, "x", color=colour)
    kHz = np.concatenate([each.judgement.spectrum.frequency for each in drawn]) / 1e3
    frequency_axis(axes)
    axes.set_xlim(kHz.min() / 1.1, kHz.max() * 1.1)
    axes.set_yticks(range(len(laws)), laws)
    axes.set_ylim(len(laws) - 0.5, -0.5)
    axes.set_title("Broken laws: a cross at each frequency")


def _legend(axes: Axes, drawn: Sequence[ColouredVerdict]) -> tuple[list[Artist], list[str]]:
    """The bands, sweeps that pass, those that break a law by name, and how many have no colour."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    named = {
        f"sweep {each.judgement.sweep}, {each.judgement.interface}": each.colour
        for each in drawn
        if each.judgement.broken and each.colour != UNNAMED
    }
    unnamed = sum(each.colour == UNNAMED for each in drawn)
    passing = {"passes": PASSING} if not all(each.judgement.broken for each in drawn) else {}
    further = {f"{unnamed} more that break a law": UNNAMED} if unnamed else {}
    told = passing | named | further
    lines = [Line2D([], [], color=colour, marker=".") for colour in told.values()]
    return [*handles, *lines], [*labels, *told]
