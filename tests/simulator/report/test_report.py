"""What reports are made of: files that appear together, and a page that shows and never obeys."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from rcskin.simulator.chart_style import chart
from rcskin.simulator.mesh.from_above import draw_foils, draw_outline, draw_pixels
from rcskin.simulator.report.files import files_in, filled_at_once, write_json, write_rows
from rcskin.simulator.report.findings import (
    Cell,
    Chart,
    DataTable,
    Findings,
    Head,
    Heading,
    Items,
)
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

HOSTILE = "<script>alert(1)</script>"


def test_files_of_a_folder_appear_together_or_not_at_all(tmp_path):
    def filled(fails):
        with filled_at_once(tmp_path / "report") as folder:
            write_rows(folder / "a.csv", ["name", "number"], [["=1+1", 2.5]])
            write_json(folder / "b.json", {"share": 1.0 / 0.0 if fails else 0.5})

    with pytest.raises(ZeroDivisionError):
        filled(True)
    assert not (tmp_path / "report").exists()
    filled(False)
    assert files_in(tmp_path / "report") == ["a.csv", "b.json"]
    assert (tmp_path / "report" / "a.csv").read_text() == "name,number\n'=1+1,2.5\n"
    assert json.loads((tmp_path / "report" / "b.json").read_text()) == {"share": 0.5}


def test_a_report_that_appears_meanwhile_is_kept_and_so_is_the_finished_one(tmp_path):
    (tmp_path / "report").mkdir()
    with pytest.raises(InputError, match=r"b\.json: already exists; .*output is in .*finished-"):
        with filled_at_once(tmp_path / "report") as folder:
            for name in ("a.json", "b.json"):
                write_json(folder / name, {"share": 0.5})
            (tmp_path / "report" / "b.json").write_text("mine")
    assert files_in(tmp_path / "report") == ["b.json"]
    assert (tmp_path / "report" / "b.json").read_text() == "mine"
    (beside,) = tmp_path.glob("finished-*")
    assert files_in(beside) == ["a.json", "b.json"]


def test_numbers_that_are_none_are_no_json(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "a.json", [np.nan])
    assert not list(tmp_path.iterdir())


def test_a_page_holds_all_that_it_is_given_and_names_are_text(tmp_path):
    def draw(path):
        with chart(path, 1, 1) as figure:
            figure.subplots()

    rows = [[HOSTILE, 2], [Cell("differs", "by a rule", agrees=False), 3]]
    numbers = DataTable("t", ["name", Head("n", form="d")], rows, csv=True)
    parts = [HOSTILE, Heading("Empty"), Heading("One"), "a paragraph", Items(["one"], ["about"])]
    found = Findings(HOSTILE, [*parts, numbers, Chart("drawn", "what it shows", draw)], "42")
    names = found.write(tmp_path / "r", page="p.html", json="p.json", charts=[".svg"])
    assert names == ["drawn.svg", "p.html", "p.json", "t.csv"]
    page = (tmp_path / "r" / "p.html").read_text(encoding="utf-8")
    assert "<script>" not in page and page.count("&lt;script&gt;") == 4
    for told in (
        "<strong>42</strong>",
        "<h2>One</h2>",
        "<p>a paragraph</p>",
        "<strong>about</strong>: one",
        '<td class="number">2</td>',
        '<td class="no">differs<br><span class="below">by a rule</span>',
        "<figcaption>what it shows</figcaption>",
        'src="data:image/png;base64,iVBOR',
    ):
        assert told in page, told


def test_foils_lie_beside_the_edge_and_pixels_end_at_holes():
    axes, scene = Figure().subplots(), load_scene("l-shape")
    draw_outline(axes, scene.parts.skin)
    outer, hole = (line.get_xydata() for line in axes.lines)
    assert np.ptp(np.hypot(*(hole - [30, 30]).T)) < 1e-6
    draw_pixels(axes, scene.parts.skin)
    inside = np.concatenate([line.get_xydata() for line in axes.lines[2:]])
    assert np.nanmin(np.hypot(*(inside - [30, 30]).T)) >= 11.9
    draw_foils(axes, scene.parts.skin)
    top, bottom = (line.get_xydata() for line in axes.lines[-2:])
    assert (top[:, 1] > outer[:, 1].max()).all()
    assert (np.hypot(*(bottom - [30, 30]).T) < 12).all()
