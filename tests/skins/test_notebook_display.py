"""Scenes, sweeps and results in a notebook: tables with small charts that need nothing else."""

import re
from xml.etree import ElementTree

import pytest
import rcskin
import xarray as xr
from matplotlib import rc_context
from rcskin.simulator import notebook_display
from rcskin.simulator.check.sweeps_view import SweepsView
from rcskin.simulator.limits.limit import Limit
from rcskin.simulator.notebook_display import SmallChart
from rcskin.simulator.report.findings import DataTable, Findings, Result

NAMESPACES = {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
SVG = "{http://www.w3.org/2000/svg}"
LARGEST = 60_000
GAIN = {"interface.left.reader": "gain", "interface.left.series_resistance": 1e5}
MULTISINE = {
    "interface.left.reader": "multisine",
    "readout": {"multisine": {"feedback_resistance": 1e5}},
}
HOSTILE = "<script>alert(1)</script> $x$ \u202e"


class Shown(Result):
    """A result of given cells and a given chart."""

    def __init__(self, cells, draw=None):
        self.cells, self.draw = cells, draw

    @property
    def report(self):
        table = DataTable("t", self.cells[:1], [(each,) for each in self.cells[1:]])
        chart = self.draw and SmallChart(self.draw)
        return Findings(self.cells[0], [table], small=lambda: chart)


def texts(shown):
    """Texts of a display and of its chart, which is well-formed, small and needs nothing else."""
    page = shown._repr_html_()
    assert len(page) < LARGEST and "\n" not in page
    assert "<script" not in page and "<style" not in page
    assert all(each.startswith("#") for each in re.findall(r'(?:href|src)="([^"]*)"', page))
    assert set(re.findall(r'https?://[^" ]*', page)) <= NAMESPACES
    tree = ElementTree.fromstring(page)
    charts = list(tree.iter(f"{SVG}svg"))
    drawn = [each.text or "" for chart in charts for each in chart.iter(f"{SVG}text")]
    return "".join(tree.itertext()), drawn


@pytest.mark.parametrize(
    "name", ["hexagon", "l with a hole", "uneven", "piezoresistive", "mesh", "draped"]
)
def test_scenes_of_every_kind_are_drawn_in_mm(kinds, name):
    text, drawn = texts(kinds[name])
    assert {"x (mm)", "y (mm)", "foil on the top sheet", "1,1"} <= set(drawn)
    assert kinds[name].name in text and "1 kHz" in text and "no chart" not in text


@pytest.mark.parametrize(
    "name, changes, words",
    [
        ("strip-1x3", {}, "1 row x 3 columns"),
        ("strip-1x3", GAIN, "V_s"),
        ("strip-1x3", MULTISINE, "frame"),
        ("knit-36", {}, "36 columns"),
        ("mug", {}, "cylinder of radius"),
        ("sheet-5x5-two-interfaces", {}, "bottom: top-bottom against bottom-bottom"),
    ],
)
def test_scenes_name_their_wiring_and_reader(name, changes, words):
    text, drawn = texts(rcskin.load(name).with_(changes))
    assert words in text and "foil on the top sheet" in drawn


def test_names_are_shown_and_never_interpreted(kinds):
    scene = kinds["uneven"].with_({"description": "<script>alert(1)</script> $x$"})
    assert "<script>alert(1)</script> $x$" in texts(scene)[0]
    text, drawn = texts(Shown([HOSTILE, HOSTILE], lambda figure: figure.suptitle(HOSTILE)))
    assert text.count("<script>alert(1)</script> $x$ \\u202e") == 4
    assert drawn == ["<script>alert(1)</script> $x$ \\u202e"]


def test_black_and_grey_are_shades_of_the_colour_of_the_page():
    def draw(figure):
        axes = figure.subplots()
        axes.plot([0, 1], color="black")
        axes.axhspan(0, 1, color="0.8", alpha=0.5)

    page = Shown(["a"], draw)._repr_html_()
    assert not re.search(r"#([0-9a-f]{2})\1\1\b", page)
    assert "stroke: currentColor" in page and re.search("fill-opacity: 0.2;? ", page)


def test_the_style_of_a_notebook_has_no_effect():
    limit = Limit("column", 0.9, 0.01, 0.2)
    plain = limit._repr_html_()
    with rc_context({"text.color": "white", "figure.constrained_layout.use": True}):
        assert limit._repr_html_() == plain


def test_a_chart_that_cannot_be_drawn_says_why_in_one_line(monkeypatch):
    def fails(figure):
        raise ValueError("two <lines>\nof text")

    assert texts(Shown(["a"], fails))[0].endswith("no chart: two <lines>\\nof text")
    monkeypatch.setattr(notebook_display, "MAX_CHART", 100)
    large = Shown(["a"], lambda figure: figure.subplots())
    assert texts(large)[0].endswith("no chart: it has too many lines for a notebook")
    assert "no table: list index out of range" in texts(Shown([]))[0]


@pytest.fixture(scope="module")
def sweeps():
    pressed = ["none", *(f"1,{k}:{factor}" for k in range(1, 6) for factor in (1.5, 2.0))]
    return rcskin.sweep("strip-1x5", [*pressed, "1,1+1,3"], rtol=1e-2)


def test_sweeps_show_the_curves_of_a_few_presses(sweeps):
    text, drawn = texts(sweeps.rcskin)
    assert "Sweeps of strip-1x5" in text and "12: 1 unpressed, 10 of one pixel, 1 of other" in text
    assert "exact line, rtol 0.01" in text and "5, from 707 Hz to 17.7 kHz" in text
    labels = {"Rs (Mohm)", "Cp (pF)", "Frequency (kHz)", "unpressed", "1,1", "1,5"}
    assert labels <= set(drawn)
    assert "Sweeps of strip-1x5" in repr(sweeps.rcskin)


@pytest.mark.parametrize("chosen", [slice(1, 2), slice(0, 1), slice(11, 12), slice(0, 0)])
def test_any_part_of_sweeps_is_shown(sweeps, chosen):
    text, drawn = texts(sweeps.isel(sweep=chosen).rcskin)
    assert "no table" not in text and "Rs (Mohm)" in drawn or chosen == slice(0, 0)


def test_gains_and_several_interfaces_are_shown():
    gains = rcskin.sweep(rcskin.load("strip-1x3").with_(GAIN), ["none"], rtol=1e-2)
    assert {"|V / V_s| (V/V)", "phase (°)"} <= set(texts(gains.rcskin)[1])
    both = xr.concat([gains, gains.assign_coords(interface=["<i>"])], "interface")
    text, drawn = texts(both.rcskin)
    assert "left, <i>" in text and "at left" in drawn


def test_what_is_no_sweeps_says_so():
    text, _ = texts(SweepsView(xr.Dataset({"x": ("sweep", [1.0])})))
    assert text.count("missing from the sweeps") == 2


def test_rates_are_bars_with_the_accuracy_of_a_guess():
    text, drawn = texts(Limit("column", 0.9, 0.01, 0.2))
    assert "Limit of column" in text and "0.2000" in text
    assert {"best classifier", "guess without a sweep", "0", "100"} <= set(drawn)
