"""Small chart of a reduced model: its answer to a few presses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...chart_style import COLOURS, UNPRESSED_COLOUR, frequency_axis, unit_axis
from ...notebook_display import CLOSE_LEGEND, SmallChart
from ...press.pixels import pixels_with_skin
from ...sweeps import UNPRESSED
from ...sweeps.reading_quantities import GAIN, IMPEDANCE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .reduced_model import Reduced

SIZE = (4.8, 2.3)
DRAWN = ("Rs", "Cp", "gain", "gain_phase")


def curves_chart(reduced: Reduced) -> SmallChart:
    """Curves of the unpressed skin and of its first, middle and last pixel at one interface."""
    return SmallChart(lambda figure: _draw(figure, reduced), *SIZE)


def _draw(figure: Figure, reduced: Reduced) -> None:
    setup = reduced.parts.setup
    f, pixels = setup.frequency, pixels_with_skin(reduced.parts.skin)
    chosen = dict.fromkeys([pixels[0], pixels[len(pixels) // 2], pixels[-1]])
    presses = [UNPRESSED, *("{},{}".format(*pixel) for pixel in chosen)]
    kind = GAIN if setup.gain else IMPEDANCE
    quantities = [each for each in kind.quantities if each.name in DRAWN]
    panels = figure.subplots(1, len(quantities))
    for press, colour in zip(presses, (UNPRESSED_COLOUR, *COLOURS), strict=False):
        reading = reduced.solve(press, f, certify=False).Z[0]
        label = "unpressed" if press == UNPRESSED else press
        for axes, each in zip(panels, quantities, strict=True):
            axes.plot(f / 1e3, each.of(reading, f), color=colour, label=label)
    for axes, each in zip(panels, quantities, strict=True):
        frequency_axis(axes)
        unit_axis(axes.yaxis, each.name, each.units)
    lines, labels = panels[0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="upper center", ncols=len(labels), **CLOSE_LEGEND)
