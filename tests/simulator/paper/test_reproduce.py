"""`rcskin reproduce` from end to end, run twice side by side."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from matplotlib.image import imread
from rcskin.localization.inputs.targets import labels
from rcskin.localization.model.file import load
from rcskin.simulator import sweeps
from rcskin.simulator.paper.rehearsal import EXPERIMENTS, SHEETS
from rcskin.simulator.paper.studies import crossed_cap

CHARTS = ("figure-2c", *EXPERIMENTS, "frequencies", "noise", "contacts")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Two folders written by two processes."""
    folders = [tmp_path_factory.mktemp(name) / "results" for name in ("first", "second")]
    command = [sys.executable, "-W", "error", "-m", "rcskin", "reproduce", "-o"]
    asked = [[str(folders[0]), "--charts", "svg"], [str(folders[1])]]
    runs = [
        subprocess.Popen([*command, *each], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for each in asked
    ]
    for run in runs:
        out, err = run.communicate(timeout=500)
        assert (run.returncode, err) == (0, b"")
        assert b"of the paper's" in out
    return folders


def test_every_table_is_the_same_bytes_on_a_second_run(results):
    first, second = results
    tables = sorted(path.name for path in first.glob("*.csv"))
    assert len(tables) == 2 * len(EXPERIMENTS) + 5
    for name in tables:
        assert (first / name).read_bytes() == (second / name).read_bytes(), name


def test_every_chart_is_drawn_and_in_the_report(results):
    report = (results[0] / "report.html").read_text()
    assert report.count('src="data:image/png;base64,') == len(CHARTS)
    for name in CHARTS:
        picture = imread(results[0] / f"{name}.png")
        assert picture[..., :3].std() > 0.03, name


def test_charts_for_papers_are_written_where_asked(results):
    asked, usual = ({path.stem for path in folder.glob("*.svg")} for folder in results)
    assert asked == {*CHARTS} and not usual


def test_the_report_stands_alone_and_holds_every_claim(results):
    report = (results[0] / "report.html").read_text()
    assert "http" not in report
    comparison = pd.read_csv(results[0] / "comparison.csv")
    assert report.count("✓ agrees") == comparison["agrees"].sum()
    assert report.count("✗ differs") == (~comparison["agrees"]).sum()
    assert comparison.notna().all().all()


def test_accuracies_are_as_the_paper_reports(results):
    accuracy = {}
    for name in EXPERIMENTS:
        table = pd.read_csv(results[0] / f"{name}-confusion.csv")
        right = table[table["target"] == table["output"]]["count"].sum()
        accuracy[name] = right / table["count"].sum()
    assert accuracy["strip-1x3"] == 1
    assert min(accuracy["sheet-3x3"], accuracy["sheet-4x4"]) > 0.9
    assert accuracy["sheet-5x5"] < accuracy["sheet-4x4"]


def test_accuracy_does_not_rise_with_noise(results):
    noise = pd.read_csv(results[0] / "noise.csv").pivot(index="multiple", columns="scene")
    assert (noise["accuracy"].diff().dropna() < 0.03).all().all()


def test_crossed_contacts_stay_below_their_cap_and_the_same_edge_above(results):
    contacts = pd.read_csv(results[0] / "contacts.csv")
    cap = contacts["n"].map(crossed_cap)
    crossed = contacts["layout"] == "crossed"
    assert (contacts["accuracy"] < cap)[crossed].all()
    assert (contacts["accuracy"] > cap)[~crossed].all()


@pytest.mark.parametrize("name", SHEETS)
def test_the_saved_model_knows_the_sweeps_it_was_trained_on(results, name):
    measured = sweeps.read(results[0] / f"{name}-sweeps.csv")
    assert np.mean(load(results[0] / f"{name}.skops").predict(measured) == labels(measured)) > 0.97


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path):
    occupied = tmp_path / "file"
    occupied.touch()
    command = [sys.executable, "-m", "rcskin", "reproduce", "-o", str(occupied)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"rcskin: {occupied}: cannot be made")
