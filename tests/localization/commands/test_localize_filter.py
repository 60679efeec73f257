"""`rcskin localize --filter` as its user meets it: of columns and of positions."""

import csv
import io

import numpy as np
import pytest
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import concatenate, write

SCENE = scene_text(load_scene("strip-1x3").with_({"skin.length": 0.03}))
LASTS, NOISE = 3, 0.012
"""Sweeps that a touch lasts, and the meter's error: one sweep alone is not always told right."""


@pytest.fixture(scope="module")
def hands(make_sweeps, tmp_path_factory):
    """Six mountings to train on, and another one that is touched for a while at each column."""
    folder = tmp_path_factory.mktemp("hands")
    known = concatenate([make_sweeps(rests=3, noise=NOISE, session=k, seed=k) for k in range(6)])
    write(known.assign_attrs(scene=SCENE), folder / "known.nc")
    unseen = make_sweeps(rests=3, session=9, seed=9, noise=NOISE)
    at = [np.flatnonzero(unseen["column"].values == column) for column in range(4)]
    order = [*at[0][:4], *at[1][:LASTS], *at[0][4:6], *at[3][:LASTS], at[0][6]]
    write(unseen.isel(sweep=order).assign_attrs(scene=SCENE), folder / "hands.nc")
    return folder


@pytest.fixture
def followed(run, hands, tmp_path):
    """A function from the target to its model's answers, row by row, alone or over time."""

    def followed(target, *options):
        model = tmp_path / f"{target}.npz"
        if not model.exists():
            kind = ["--estimator", "kernel-ridge"] if target == "position" else []
            asked = ("--target", target, *kind, "--features", "dlnZ,dphase", "-o", model)
            assert run("train", hands / "known.nc", *asked)[0] == 0
        code, out, _ = run("localize", model, hands / "hands.nc", *options)
        assert code == 0
        return list(csv.DictReader(io.StringIO(out)))

    return followed


def truth(rows):
    return ["0" if row["press"] == "none" else row["press"][2] for row in rows]


def test_columns_are_found_by_all_sweeps_of_a_touch(followed):
    alone, rows = followed("column"), followed("column", "--filter", "--touch-lasts", 1.2)
    assert "changed" in rows[0] and "changed" not in alone[0]
    wrong = [
        sum(row["answer"] != right for row, right in zip(each, truth(each), strict=True))
        for each in (alone, rows)
    ]
    assert wrong[1] <= wrong[0] <= 4
    assert rows[6]["answer"] == "1" and rows[11]["answer"] == "3"
    assert max(float(row["changed"]) for row in rows) < 0.5


def test_positions_are_followed_and_no_more_reported_when_the_touch_has_gone(followed):
    rows = followed("position", "--filter", "--touch-lasts", 1.2)
    for row in rows:
        assert (row["x_mm"] != "") == (row["answer"] == "1")
    for k, x in ((6, 5.0), (11, 25.0)):
        assert rows[k]["answer"] == "1" and abs(float(rows[k]["x_mm"]) - x) < 5
        assert 0 < float(rows[k]["x_mm_deviation"]) < 10
    assert rows[8]["answer"] != "1"


def test_a_pace_of_nothing_is_refused(run, refused, hands, tmp_path):
    asked = ("--features", "dlnZ,dphase", "-o", tmp_path / "m.npz")
    assert run("train", hands / "known.nc", *asked)[0] == 0
    assert "--pace must be from 0.001 to 1e+06, got 0" in refused(
        "localize", tmp_path / "m.npz", hands / "hands.nc", "--filter", "--pace", 0
    )
