"""What `view` says of foam that creeps."""

from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.scene.scene_files import load_scene, write_scene
from rcskin.simulator.view import command


def test_fields_are_those_at_the_moment_of_the_press(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(Elements, "fields", lambda *_: None)
    creep = [{"share": 0.1, "time_constant": 1.0}]
    path = str(tmp_path / "mine.toml")
    write_scene(path, load_scene("strip-1x3").with_({"skin.foam.relaxation": creep}))
    for scene, told in ((path, 1), ("strip-1x3", 0)):
        command._viewed_press(scene, "1,2", [1e3], None, 1e-2, False, None)
        said = "moment of the press, before `skin.foam.relaxation` has an effect"
        assert capsys.readouterr().err.count(said) == told
