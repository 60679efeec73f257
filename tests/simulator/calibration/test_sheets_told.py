"""Of sheets that one field sees the sum is told; their ratio is assumed unless it is known."""

import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate

TRUTH = {"sheet_resistance": 0.25, "capacitance": -0.3, "phase_exponent": 0.96}
REST = ("none",) * 4


def test_one_field_determines_the_sum_of_its_sheets_and_not_each(make_scene, line, read):
    scene = line.model_copy(update={"skin": make_scene(top=20e3, bottom=35e3).skin})
    twin = scene.with_({"skin.top.sheet_resistance": 27e3})
    found = calibrate(scene, read(twin, presses=(*REST, "1,1", "1,2", "1,3")))
    of = {each.name: each for each in found.quantities}
    assert of["both in series"].source == "data"
    assert of["both in series"].low < 62e3 < of["both in series"].high
    assert of["both in series"].high < 1.1 * of["both in series"].low
    assert of["top over bottom"].value == pytest.approx(20 / 35)
    assert of["top over bottom"].low < 27 / 35 < of["top over bottom"].high
    for name, truth in (("top sheet", 27e3), ("bottom sheet", 35e3)):
        assert of[name].source == "prior"
        assert of[name].low < truth < of[name].high
        assert of[name].high < of["both in series"].high
    assert of["top sheet"].high > 2 * of["top sheet"].low
    assert not (found.identified["sheet_resistance"] or found.identified["sheet_mismatch"])


def test_a_known_ratio_leaves_each_sheet_determined(line, read):
    found = calibrate(line, read(line, TRUTH, REST), Options(fix=("sheet_mismatch",)))
    assert found.not_fitted == ()
    assert {each.name: each.identified for each in found.quantities}["top sheet"]
    assert "top over bottom" not in [each.name for each in found.quantities]
