"""Variants of foils and graded sheets, and their symmetries."""

import pytest
from rcskin.simulator.design.evaluator import SceneEvaluator, SearchJournal, SearchSettings
from rcskin.simulator.design.layout import material_of
from rcskin.simulator.design.reading_pool import geometries, graded, moved, terminals
from rcskin.simulator.design.search import search
from rcskin.simulator.scene.design_goals import Design
from rcskin.simulator.scene.scene_files import load_scene

SHEET = load_scene("sheet-5x5-two-interfaces")
FOILS = {"top-left": {"span": [0.0, 0.3]}, "bottom-left": {"span": [0.0, 0.3]}}
NOISE = {"magnitude_noise": 0.04, "phase_noise": 0.04}


def test_geometry_is_fixed_by_default():
    assert geometries(SHEET.parts.skin, Design()) == []
    named = [name for name, _ in geometries(SHEET.parts.skin, Design(foils=True, grading=4.0))]
    assert named == ["foils on the left edge", "foils on the bottom edge", "graded sheets"]


def test_foils_stay_within_their_bounds_and_do_not_overlap():
    found = moved(("top-left", "bottom-left"), (0.2, 0.9), SHEET)
    assert len(found) >= 6
    for each in found:
        low, high = each.parts.skin.contact("top-left").span
        assert each.parts.skin.contact("bottom-left").span == (low, high)
        assert 0.2 - 1e-9 <= high - low <= 0.9 + 1e-9
        assert len(terminals(each.parts.skin)) == 4


def test_graded_sheets_stay_within_the_largest_ratio():
    found = graded(9.0, SHEET)
    assert len(found) == 8
    for each in found:
        gradient = each.skin.top.map
        rise = abs(gradient.x + gradient.y) / 2
        assert (1 + rise) / (1 - rise) == pytest.approx(3.0) or (
            (1 + rise) / (1 - rise) == pytest.approx(9.0)
        )


def test_mirrored_foils_have_equal_merit_and_the_best_for_columns_are_symmetric(strip):
    scene = strip(contacts=FOILS, rows=2, columns=2, width=0.1, frequencies=(1e4,), readout=NOISE)
    even = {"sheet_resistance": 1.0, "capacitance": 1.0, "foam_spread": 0.0, "loss_tangent": 0.0}
    scene = scene.with_(
        {
            "dataset.session": {**scene.dataset.session.model_dump(), **even},
            "experiment.unpressed": False,
        }
    )
    asked = Design(
        target="column",
        foils=True,
        foil_length=(0.3, 1.0),
        readings=1,
        casts=1,
        sheet_resistance=(50e3, 50e3),
        sheet_ratio=1.0,
    )
    asking = SearchSettings(asked, 1, 100, SearchJournal(None, {}), lambda *_: None)
    mirrored = scene.with_({f"contact.{name}.span": [0.7, 1.0] for name in FOILS})
    shares = [
        SceneEvaluator(each.parts, asking, terminals(each.parts.skin)).share_of(
            material_of(each.parts.skin), [0], [0]
        )
        for each in (scene, mirrored)
    ]
    assert shares[0] == pytest.approx(shares[1], abs=2e-3)
    found = search(scene.parts, asking)
    told = [(step.name, step.tenth) for step in found.steps]
    assert found.best.name == "foils on the left edge", told
    low, high = found.evaluator.parts.skin.contact("top-left").span
    assert low == pytest.approx(1 - high)
