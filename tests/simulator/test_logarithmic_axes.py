"""Logarithmic axes tell numbers at four places at least."""

import matplotlib.pyplot as plt
import pytest
from rcskin.simulator.chart_style import MAX_TICKS, MIN_TICKS, plain_numbers


@pytest.mark.parametrize(
    ("low", "high"),
    [
        (0.8, 60),
        (1.5, 900),
        (4e3, 3e4),
        (4e3, 2.5e4),
        (0.021, 0.028),
        (2.2, 2.9),
        (1e3, 1e6),
        (1e-9, 1e9),
    ],
)
@pytest.mark.parametrize("name", ["x", "y"])
def test_logarithmic_axes_have_at_least_four_labelled_ticks(low, high, name):
    figure, axes = plt.subplots()
    axes.set(xlim=(low, high), ylim=(low, high), xscale="log", yscale="log")
    ruler = axes.xaxis if name == "x" else axes.yaxis
    plain_numbers(ruler)
    figure.canvas.draw()
    ticks = [*ruler.get_major_ticks(), *ruler.get_minor_ticks()]
    told = [
        tick.label1.get_text()
        for tick in ticks
        if low <= tick.get_loc() <= high and tick.label1.get_text()
    ]
    plt.close(figure)
    assert MAX_TICKS + 1 >= len(set(told)) == len(told) >= MIN_TICKS
