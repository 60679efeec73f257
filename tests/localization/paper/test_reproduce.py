"""`rcskin reproduce` from end to end."""

import subprocess
import sys
from html import escape
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.image import imread
from rcskin.__main__ import app
from rcskin.localization.inputs.targets import labels
from rcskin.localization.model.localizer_file import load
from rcskin.localization.paper import figures
from rcskin.localization.paper.claims import RULES, near
from rcskin.localization.paper.reproduce import charts_of
from rcskin.localization.paper.studies import EXPERIMENTS, SHEETS, crossed_cap
from rcskin.simulator import sweeps
from rcskin.simulator.chart_style import STYLE
from rcskin.simulator.report.findings import Findings
from rcskin.simulator.scene.scene_files import load_scene
from typer.testing import CliRunner

CHARTS = ("figure-2c", *EXPERIMENTS, "frequencies", "noise", "contacts")


FEWER_DRAWS = 1
"""Of the meter's noise, where what is said of their mean holds already."""


def reproduced(folder, *options):
    """The folder, written by a process of its own."""
    command = [sys.executable, "-W", "error", "-m", "rcskin", "reproduce", "-o", str(folder)]
    run = subprocess.run([*command, *options], capture_output=True, timeout=500)
    assert (run.returncode, run.stderr) == (0, b"")
    assert b"of the paper's" in run.stdout
    return folder


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The folder of a run with fewer draws and coarser pictures."""
    folder = tmp_path_factory.mktemp("first") / "results"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rcskin.localization.paper.studies.DRAWS", FEWER_DRAWS)
        patch.setitem(STYLE, "savefig.dpi", 50)
        done = CliRunner().invoke(app, ["reproduce", "-o", str(folder)])
    assert (done.exit_code, done.stderr) == (0, "")
    assert "of the paper's" in done.stdout
    return folder


def test_the_tables_are_there(results):
    assert len([*results.glob("*.csv")]) == 2 * len(EXPERIMENTS) + 5


@pytest.mark.slow
def test_every_table_is_the_same_bytes_on_a_second_run(tmp_path):
    first = reproduced(tmp_path / "first")
    second = reproduced(tmp_path / "second", "--charts", "svg")
    for table in first.glob("*.csv"):
        assert table.read_bytes() == (second / table.name).read_bytes(), table.name
    assert {path.stem for path in second.glob("*.svg")} == {*CHARTS}


def test_every_chart_is_drawn_and_in_the_report(results):
    report = (results / "report.html").read_text(encoding="utf-8")
    assert report.count('src="data:image/png;base64,') == len(CHARTS)
    for name in CHARTS:
        picture = imread(results / f"{name}.png")
        assert picture[..., :3].std() > 0.03, name


@pytest.mark.parametrize("ending", [".png", ".svg"])
def test_charts_for_papers_are_written_beside_the_pictures(tmp_path, monkeypatch, ending):
    """Of charts that are drawn by a word in their file."""
    drawing = [name for name in vars(figures) if name.endswith("_figure")]
    for name in drawing:
        monkeypatch.setattr(figures, name, lambda path, *_: path.write_text("drawn"))
    scenes = {name: SimpleNamespace(scene=load_scene(name)) for name in EXPERIMENTS}
    none = dict.fromkeys(("frequency", "noise", "contact"))
    results = SimpleNamespace(experiments=scenes, confusions=scenes, **none)
    Findings("", charts_of(results)).write(tmp_path, charts=(".png", ending))
    for each in {".png", ending}:
        assert {path.stem for path in tmp_path.glob(f"*{each}")} == {*CHARTS}
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ending}


def test_the_report_stands_alone_and_holds_every_claim(results):
    report = (results / "report.html").read_text(encoding="utf-8")
    assert "http" not in report
    comparison = pd.read_csv(results / "comparison.csv")
    assert report.count("✓ agrees") == comparison["agrees"].sum()
    assert report.count("✗ differs") == (~comparison["agrees"]).sum()
    assert comparison.notna().all().all()
    assert report.rindex("✗ differs") < report.index("✓ agrees")
    noisy = comparison[comparison["topic"].str.contains("ccuracy|Errors|Contact|against 20")]
    assert len(noisy) == 9 and (noisy["noise"] != "none").all()
    assert all(escape(rule, quote=False) in report.replace("&#39;", "'") for rule in RULES.values())


def test_a_statement_agrees_on_the_device_of_the_paper_alone(results):
    """Foils on two edges confuse columns; foils on one edge show mirrored rows alike."""
    agrees = pd.read_csv(results / "comparison.csv").set_index("topic")["agrees"]
    told = {topic.partition(" ")[0]: value for topic, value in agrees.items()}
    assert not told["Contact"] and not told["Rows"]
    assert told["Sensitivity"] and told["Resolution"]


@pytest.mark.parametrize(
    ("ours", "paper", "agrees"), [(1.14, 1, True), (1.16, 1, False), ([1, 0.8], 1, False)]
)
def test_numbers_agree_within_one_tolerance(ours, paper, agrees):
    assert near(ours, paper) == agrees


def test_accuracies_are_as_the_paper_reports(results):
    accuracy = {}
    for name in EXPERIMENTS:
        table = pd.read_csv(results / f"{name}-confusion.csv")
        right = table[table["target"] == table["output"]]["count"].sum()
        accuracy[name] = right / table["count"].sum()
    assert accuracy["strip-1x3"] == 1
    assert min(accuracy["sheet-3x3"], accuracy["sheet-4x4"]) > 0.9
    assert accuracy["sheet-5x5"] < accuracy["sheet-4x4"]


def test_accuracy_does_not_rise_with_noise(results):
    noise = pd.read_csv(results / "noise.csv").pivot(index="multiple", columns="scene")
    assert (noise["accuracy"].diff().dropna() < 0.03).all().all()


def test_crossed_contacts_stay_below_their_cap_and_the_same_edge_above(results):
    contacts = pd.read_csv(results / "contacts.csv")
    cap = contacts["n"].map(crossed_cap)
    crossed = contacts["layout"] == "crossed"
    assert (contacts["accuracy"] < cap)[crossed].all()
    assert (contacts["accuracy"] > cap)[~crossed].all()


@pytest.mark.parametrize("name", SHEETS)
def test_the_saved_model_knows_the_sweeps_it_was_trained_on(results, name):
    measured = sweeps.read(results / f"{name}-sweeps.csv")
    assert np.mean(load(results / f"{name}.npz").predict(measured) == labels(measured)) > 0.97


@pytest.mark.parametrize("name", ["sheet-5x5-sweeps.csv", "figure-2c.svg", "report.html"])
def test_what_is_there_is_refused_before_anything_is_computed(refused, tmp_path, monkeypatch, name):
    monkeypatch.setattr("rcskin.localization.paper.reproduce._experiments", None)
    (tmp_path / name).write_text("mine")
    assert f"{name}: already exists; --overwrite replaces it" in refused(
        "reproduce", "-o", tmp_path
    )
    assert [path.read_text() for path in tmp_path.iterdir()] == ["mine"]


def test_a_folder_that_cannot_be_made_is_bad_input(refused, tmp_path):
    occupied = tmp_path / "file"
    occupied.touch()
    err = refused("reproduce", "-o", occupied)
    assert err.startswith(f"rcskin: {occupied}: cannot be written: is a file")
