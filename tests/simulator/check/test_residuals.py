"""The chart of a check: what is beyond the band is what breaks the law, and every law is marked."""

from contextlib import contextmanager

import numpy as np
import pytest
from rcskin.simulator.check.report import draw_residuals
from rcskin.simulator.sweeps.examination import KRAMERS_KRONIG, examine

FREQUENCY = np.geomspace(1e3, 2e5, 20)


def line(RC=1e-5):
    q = np.sqrt(2j * np.pi * FREQUENCY * RC)
    return 1e5 / (q * np.tanh(q))


@pytest.fixture
def judge(make_sweeps):
    """A function that judges spectra, shape (sweep, frequency), of one interface."""

    def judge(Z, noise=None):
        Z = np.atleast_2d(Z)
        return examine(make_sweeps(len(Z), ["meter"], FREQUENCY, Z[:, None]), noise)

    return judge


def test_the_chart_is_a_whole_PNG(judge, tmp_path):
    draw_residuals(judge(line()), tmp_path / "chart.png")
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(tmp_path.iterdir())) == 1


@pytest.fixture
def figures(monkeypatch, tmp_path, replacing):
    """A function that draws the chart of judgements and gives the figure."""
    from rcskin.simulator import chart_style
    from rcskin.simulator.check import report as residuals

    @contextmanager
    def kept(*size):
        with chart_style.chart(*size) as figure:
            yield figure
            drawn.append(figure)

    drawn = []
    monkeypatch.setattr(residuals, "chart", kept)

    def figures(judged):
        draw_residuals(judged, tmp_path / "chart.png")
        return drawn[-1]

    return figures


def crosses(axes):
    lines = [line for line in axes.get_lines() if line.get_marker() == "x"]
    return [line.get_xydata() for line in lines if len(line.get_xdata())]


def test_a_resistance_below_zero_is_outside_the_band_and_at_every_frequency_of_its_law(
    judge, figures
):
    (judged,) = judge(-line().conj())
    told = {law.law: np.array(law.frequency) / 1e3 for law in judged.broken}
    assert len(told["Re Z >= 0"]) == len(told[KRAMERS_KRONIG]) == 20
    figure = figures([judged])
    real, imaginary, laws = figure.axes
    outside = {*crosses(real)[0][:, 0], *crosses(imaginary)[0][:, 0]}
    assert sorted(outside) == told[KRAMERS_KRONIG].tolist()
    names = [label.get_text() for label in laws.get_yticklabels()]
    marked = dict(zip(names, crosses(laws), strict=False))
    assert {name: found[:, 0].tolist() for name, found in marked.items()} == {
        name: f.tolist() for name, f in told.items()
    }
    assert figure.get_suptitle() == "1 of 1 spectra break a law"


def test_a_broken_law_that_leaves_the_network_within_what_is_allowed_is_marked_as_a_law_alone(
    judge, figures
):
    (judged,) = judge(line(), noise=1e-3)
    assert len(figures([judged]).axes) == 2
    broken = judge(np.array([line(), line()]) * np.array([[1], [-1]]))
    assert [len(each.broken) for each in broken][0] == 0 < len(broken[1].broken)
    labels = [text.get_text() for text in figures(broken).legends[0].get_texts()]
    assert "passes" in labels and "sweep 1, meter" in labels


def test_more_broken_sweeps_than_colours_are_counted(judge, figures):
    judged = judge(np.array([-line()] * 9))
    labels = [text.get_text() for text in figures(judged).legends[0].get_texts()]
    assert "3 more that break a law" in labels and "passes" not in labels
