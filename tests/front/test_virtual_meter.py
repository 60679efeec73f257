"""The virtual meter as the command line wires it to a scene."""

import rcskin
from rcskin.hardware.cli import Serve
from rcskin.simulator.scene.scene_files import scene_text

PARTS = ("magnitude", "phase")


def test_a_virtual_meter_without_noise_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.virtual.serving.serve", lambda *_: None)
    scene = rcskin.load("strip-1x3")
    noise = {f"readout.{part}_{kind}": 0.0 for part in PARTS for kind in ("accuracy", "noise")}
    path = tmp_path / "silent.toml"
    for asked, lines in ((scene, 0), (scene.with_(noise), 1)):
        path.write_text(scene_text(asked), encoding="utf-8")
        Serve.of({"scene": str(path)}).run()
        err = capsys.readouterr().err
        assert err.count("\n") == lines and ("the readout is free of noise" in err) == bool(lines)
