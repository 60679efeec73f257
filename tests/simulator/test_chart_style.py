"""Charts are pictures or lines, by the ending of their file."""

import os
import subprocess
import sys

import pytest
from matplotlib.figure import Figure
from rcskin.simulator.chart_style import (
    ENDINGS,
    chart,
    checked_chart,
    checked_ending,
    frequency_axis,
    unit_axis,
)
from rcskin.simulator.safe_text import escaped
from rcskin.simulator.sweeps import InputError

BEGINS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_chart_is_what_its_name_ends_in_and_the_same_bytes_again(tmp_path, ending):
    written = []
    for name in ("one", "other"):
        with chart(tmp_path / f"{name}{ending}", 2, 1) as figure:
            figure.subplots().plot([0, 1])
        written.append((tmp_path / f"{name}{ending}").read_bytes())
    assert written[0].startswith(BEGINS[ending])
    assert written[0] == written[1]


def test_other_endings_are_reported_before_anything_is_drawn(tmp_path):
    assert checked_chart(tmp_path / "a.svg") == tmp_path / "a.svg"
    with pytest.raises(InputError, match="must end in .png or .svg or .pdf, got '.jpg'"):
        checked_chart(tmp_path / "a.jpg")


def test_charts_in_a_folder_have_the_ending_that_is_named():
    assert checked_ending("pdf") == ".pdf"
    with pytest.raises(InputError, match="--charts must be png or svg or pdf, got 'jpg'"):
        checked_ending("jpg")


@pytest.mark.parametrize(
    ("values", "label", "numbers"),
    [
        ([2e4, 9e4], "Rs (kohm)", (20, 90)),
        ([1e-11, 9e-11], "Rs (pohm)", (10, 90)),
        ([-4e6, 1.0], "Rs (Mohm)", (-4, 0)),
        ([0.0, 0.0], "Rs (mohm)", (-60, 60)),
    ],
)
def test_an_axis_has_its_unit_in_the_label_and_bare_numbers_at_ticks(values, label, numbers):
    figure = Figure()
    axes = figure.subplots()
    axes.plot(values)
    unit_axis(axes.yaxis, "Rs", "ohm")
    figure.draw_without_rendering()
    assert axes.get_ylabel() == label
    escaped = [
        float(t.label1.get_text().replace("\u2212", "-")) for t in axes.yaxis.get_major_ticks()
    ]
    assert min(escaped) <= numbers[0] and numbers[1] <= max(escaped) < 1000


@pytest.mark.parametrize("high, least, most", [(6.5, 4, 9), (15, 4, 11), (90, 4, 6), (1000, 4, 4)])
def test_a_frequency_axis_has_plain_labels_enough_to_read_and_few_enough(high, least, most):
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0.7, high], [0, 1])
    frequency_axis(axes)
    figure.draw_without_rendering()
    low, top = axes.get_xlim()
    ticks = [*axes.xaxis.get_major_ticks(), *axes.xaxis.get_minor_ticks()]
    told = [t.label1.get_text() for t in ticks if low <= t.get_loc() <= top]
    labels = [each for each in told if each]
    assert least <= len(labels) <= most
    assert all(float(each) > 0 for each in labels)


@pytest.mark.parametrize("name", [r"$\frac{$", "a$b$c", r"\x", "\x1b[31mred", "100 $"])
def test_names_stand_in_charts_as_they_are(tmp_path, name):
    with chart(tmp_path / "named.svg", 3, 2) as figure:
        axes = figure.subplots()
        axes.plot([1, 10], [1, 10], label=name)
        axes.set(title=name, xlabel=name, yscale="log")
        axes.set_xticks([1, 5], [name.lstrip("\x1b")] * 2)
        axes.legend()
    texts = [each.get_text() for each in (axes.title, axes.xaxis.label)]
    assert texts == [escaped(name)] * 2


def test_a_backend_that_matplotlib_lacks_is_refused_in_scripts():
    told = subprocess.run(
        [
            sys.executable,
            "-c",
            "import rcskin, xarray as xr; rcskin.plot(xr.Dataset(), 'chart.png')",
        ],
        env={**os.environ, "MPLBACKEND": "nonsense"},
        capture_output=True,
        text=True,
        check=False,
    )
    last = told.stderr.splitlines()[-1]
    assert "MPLBACKEND must name a backend of matplotlib, got 'nonsense': unset it" in last
