"""A study that folds in keys of materials."""

import pytest
from rcskin.localization.study.axis import Axis, find_key, scene_table
from rcskin.localization.study.execution import points_of
from rcskin.localization.study.point import EvaluationSettings
from rcskin.simulator.scene.scene_files import BUILTIN


def test_a_study_may_stretch_a_skin(tmp_path):
    """Its points are the plain scenes that the stretched ones are."""
    path = tmp_path / "mine.toml"
    sheet = (BUILTIN / "sheet-3x3.toml").read_text()
    path.write_text(f"{sheet}\n[skin.stretch]\nx = 1.0\ny = 1.0\n")
    table = scene_table(str(path))
    axis = Axis(find_key("skin.stretch.x", table), (1.0, 1.25))
    rest, pulled = points_of(table, [axis], EvaluationSettings())
    assert (rest.skin.uniform, pulled.skin.uniform) == (True, True)
    assert rest.skin.sides == (0.12, 0.12)
    assert pulled.skin.sides == (0.15, 0.12)
    assert pulled.skin.top.sheet_resistance == pytest.approx(1.25 * 50e3)
