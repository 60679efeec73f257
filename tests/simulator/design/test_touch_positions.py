"""Designs for positions: slopes against the full solver, and the command."""

import json

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.position_bound import place_likelihood
from rcskin.simulator.design.evaluator import SceneEvaluator, SearchJournal, SearchSettings
from rcskin.simulator.design.goals import CELLS, TouchPositions
from rcskin.simulator.design.reading_pool import terminals
from rcskin.simulator.scene.design_goals import Design

POSITIONS = {"target": "position", "casts": 1, "sheet_ratio": 1.0, "readings": 2}


@pytest.fixture(scope="module")
def scene(make_scene):
    """A sheet of few pixels with two pairs of foils."""
    apart = {"span": [0.02, 1.0]}
    foils = {f"{sheet}-{edge}": apart for edge in ("left", "bottom") for sheet in ("top", "bottom")}
    ways = {edge: (f"top-{edge}", f"bottom-{edge}") for edge in ("left", "bottom")}
    tones = (300.0, 1e3, 3e3, 1e4)
    made = make_scene(foils, ways, rows=2, columns=2, frequencies=tones, bottom=50e3)
    noise = {"magnitude_noise": 3e-3, "phase_noise": 3e-3}
    return made.with_({"readout": noise, "dataset.session.unevenness": 0.0})


def bench(scene):
    asking = SearchSettings(Design(**POSITIONS), 1, 100, SearchJournal(None, {}), lambda *_: None)
    return SceneEvaluator(scene.parts, asking, terminals(scene.parts.skin))


def test_bounds_are_those_of_the_full_solver(scene):
    found, touches = bench(scene), TouchPositions(scene.parts, 6)
    on = found._trained.readout(None, found.own.material, scene.interfaces)
    told = touches.at_places(on, scene.frequencies)
    fields = FullFields(scene.parts, float(scene.frequencies[-1]), CELLS)
    exact = place_likelihood(
        fields, touches.places, touches.size, scene.frequencies, against_rest=6
    )
    for name in ("x", "y", "strength"):
        one, other = (getattr(each.bounds(), name) for each in (told, exact))
        assert np.isfinite(other).any()
        np.testing.assert_allclose(one, other, rtol=0.05)


def test_a_share_is_refused_for_positions(run, refused, strip_file):
    code, _, err = run("design", strip_file, "--target", "position", "--want", 0.9)
    assert code == 2 and "use `within`" in err and err.count("\n") == 1
    assert "within belongs to the target position" in refused("design", strip_file, "--within", 3)


def test_a_search_for_positions_reports_millimetres(run, strip_file, tmp_path):
    quick = ("--casts", 1, "--sheet-ratio", 1, "--target", "position")
    code, out, err = run("design", strip_file, *quick, "--within", 1e-2, "-o", tmp_path / "d")
    assert (code, err) == (0, "")
    assert out.startswith(
        "0.01 mm is not reached by any design found; the best: smallest median error"
    )
    numbers = json.loads((tmp_path / "d" / "design.json").read_text())
    first, *_, last = (each["nine_of_ten_samples"] for each in numbers["steps"])
    assert first <= last < 1 and numbers["distance_of_a_guess_m"] > 0
    page = (tmp_path / "d" / "report.html").read_text(encoding="utf-8")
    assert "Cramér and Rao" in page and "a tenth of a millimetre" in page
