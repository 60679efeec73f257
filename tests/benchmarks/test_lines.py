"""The chart of measured RC lines shows the intervals of its table."""

import re
from types import SimpleNamespace

import pandas as pd
from rcskin.benchmarks.bench import HERE
from rcskin.benchmarks.measured.lines import resistance_over_published, resistance_range


def sweeps():
    """Sweeps of the table with a published resistance."""
    table = pd.read_csv(HERE / "results" / "lines.csv").dropna(subset="published resistance")
    for _, row in table.iterrows():
        value, low, high = map(float, re.findall(r"[\d.]+", row["resistance, ohm"]))
        quantity = SimpleNamespace(value=value, low=low, high=high)
        yield SimpleNamespace(
            broken=[law for law in [row["check"]] if law != "passes"],
            published={"r_ion_ohm": float(row["published resistance"])},
            quantity=lambda name, quantity=quantity: quantity,
        )


def test_the_chart_holds_every_interval_of_a_sweep_that_passes():
    every = list(sweeps())
    passing = [each for each in every if not each.broken]
    assert len(passing) == 17
    start, end = resistance_range(every)
    assert 0.1 < start and end < 10, "sweeps that break a law do not stretch the chart"
    for low, value, high in map(resistance_over_published, passing):
        assert start < low < value < high < end
