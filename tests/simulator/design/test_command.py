"""The command `rcskin design`: its folder, interrupted searches, unreachable goals, bad input."""

import csv

import pytest
from rcskin.simulator.design.evaluator import SceneEvaluator
from rcskin.simulator.scene.scene_files import load_scene, scene_text

QUICK = ("--casts", 1, "--draws", 40, "--sheet-ratio", 1)


def test_a_killed_search_goes_on_to_the_same_bytes(run, strip_file, tmp_path, monkeypatch):
    asked = ("design", strip_file, *QUICK, "--want", 0.999999)
    code, out, err = run(*asked, "-o", tmp_path / "whole")
    assert (code, err) == (0, "")
    assert out.startswith(
        "99.9999 % is not reached by any design found; the best: largest share of"
    )
    own, left = SceneEvaluator.merits, [3]

    def shares(bench, layout):
        if not left[0]:
            raise KeyboardInterrupt
        left[0] -= 1
        return own(bench, layout)

    monkeypatch.setattr(SceneEvaluator, "merits", shares)
    assert run(*asked, "-o", tmp_path / "again")[0] != 0
    assert not (tmp_path / "again").exists() and (tmp_path / ".again.search").is_dir()
    monkeypatch.setattr(SceneEvaluator, "merits", own)
    monkeypatch.setattr(
        "rcskin.simulator.design.trained_skins.TrainedSkins.sample", _counted(kept := [])
    )
    assert run(*asked, "-o", tmp_path / "again")[0] == 0
    assert kept and not (tmp_path / ".again.search").exists()
    names = sorted(path.name for path in (tmp_path / "whole").iterdir())
    assert {"design.toml", "design.json", "wiring.csv", "report.html"} < set(names)
    for name in names:
        one, other = ((tmp_path / folder / name).read_bytes() for folder in ("whole", "again"))
        assert one == other, name
    _check_folder(run, tmp_path / "whole")


def _counted(kept):
    from rcskin.simulator.design.trained_skins import TrainedSkins

    own = TrainedSkins.sample

    def cast(trained, number):
        kept.append(number)
        return own(trained, number)

    return cast


def _check_folder(run, folder):
    """Other commands take the scene, and the table says how it is wired."""
    found = load_scene(folder / "design.toml")
    rows = list(csv.DictReader((folder / "wiring.csv").read_text().splitlines()))
    assert [row["reading"] for row in rows] == [each.name for each in found.interfaces]
    assert [row["high"] for row in rows] == [" + ".join(each.high) for each in found.interfaces]
    assert run("sweep", folder / "design.toml", "-o", folder / "all.csv")[0] == 0
    assert run("describe", folder / "design.toml", "-o", folder / "drawn.png")[0] == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    for told in ("Gain of each step", "What to make", "kohm/sq", "less than one percentage point"):
        assert told in page


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (("--want", 1.5), "`want` must be < 1"),
        (("--sheet-resistance", "5"), "--sheet-resistance must be LOW:HIGH, got '5'"),
        (("--sheet-resistance", "5e4:1e4"), "sheet_resistance must be a low and a high end"),
        (("--target", "colour"), "`target` must be 'pixel'"),
        (("--seconds", "1e-3"), "`design.seconds` must be >= 0.005 s"),
        (("-o", "there/is/none"), "there/is/none: the folder there/is does not exist"),
    ],
)
def test_bad_constraints_are_refused_in_one_line(refused, strip_file, given, told):
    assert told in refused("design", strip_file, *given)


def test_a_meter_without_noise_is_refused(refused, strip, tmp_path):
    path = tmp_path / "exact.toml"
    path.write_text(scene_text(strip(readout={})), encoding="utf-8")
    assert "noise" in refused("design", path, *QUICK, "-o", tmp_path / "d")
    assert not (tmp_path / "d").exists()


def test_presses_that_a_tension_spreads_are_refused(refused, tmp_path):
    assert "press.capacitance_factor" in refused("design", "foam", "-o", tmp_path / "d")


def test_different_sheets_stay_within_the_bounds(run, refused, strip, tmp_path):
    path = tmp_path / "unlike.toml"
    path.write_text(scene_text(strip(top=20e3, bottom=60e3)), encoding="utf-8")
    asked = ("design", path, *QUICK, "--sheet-resistance")
    assert run(*asked, "10e3:100e3", "-o", tmp_path / "d")[0] == 0
    skin = load_scene(tmp_path / "d" / "design.toml").skin
    sheets = skin.top.sheet_resistance, skin.bottom.sheet_resistance
    assert 10e3 * (1 - 1e-6) <= min(sheets) and max(sheets) <= 100e3 * (1 + 1e-6)
    assert sheets[1] / sheets[0] == pytest.approx(3, rel=0.05)
    assert "is too narrow for sheets" in refused(*asked, "10e3:20e3", "-o", tmp_path / "e")
