"""A measured blocking electrode, which physically is a line: how far the model follows it."""

import json
from pathlib import Path

import pytest

MEASURED = Path(__file__).parents[4] / "shared" / "data" / "blocking_line_eis.csv"
SCENE = """
name = "blocking electrode"
plausible = false
[skin]
length = 0.1
width = 0.1
[skin.top]
sheet_resistance = {resistance}
[skin.bottom]
sheet_resistance = {resistance}
[skin.foam]
capacitance_per_area = {capacitance}
[[contact]]
name = "high"
electrode = "top"
edge = "left"
[[contact]]
name = "low"
electrode = "bottom"
edge = "left"
[[interface]]
name = "meter"
high = ["high"]
low = ["low"]
[pixels]
rows = 1
columns = 1
[sweep]
frequencies = [1.0, 1000.0]
"""
CONSTANT_PHASE = ["--fix=others"] + [
    f"--fit={name}"
    for name in (
        "sheet_resistance",
        "capacitance",
        "phase_exponent",
        "lead_resistance",
        "lead_inductance",
    )
]


NEAR, FAR_OFF = (1e-3, 100.0), (50e3, 5e-9)
"""Sheet resistance and capacitance per area of a scene to begin with."""


@pytest.fixture
def calibrated(run, tmp_path):
    """Calibrates, below 1 kHz, with further arguments; gives numbers and what was told."""
    if not MEASURED.exists():
        pytest.skip(f"the measured sweep {MEASURED.name} is not beside the project")
    scene, sweeps, folder = tmp_path / "line.toml", tmp_path / "eis.nc", tmp_path / "found"
    run("import", MEASURED, "--press", "none", "--interface", "meter", "-o", sweeps)

    def calibrated(*more, start=NEAR):
        scene.write_text(SCENE.format(resistance=start[0], capacitance=start[1]))
        code, out, err = run("calibrate", scene, sweeps, "--band", ":1000", "-o", folder, *more)
        assert code == 0 and all(
            "the scene has no [surroundings]" in line for line in err.splitlines()
        )
        return json.loads((folder / "calibration.json").read_text()), out

    return calibrated


@pytest.mark.usefixtures("linear_intervals")
@pytest.mark.parametrize(
    "start", [NEAR, pytest.param(FAR_OFF, marks=pytest.mark.slow)], ids=["near", "far off"]
)
def test_a_constant_phase_capacitance_follows_it(calibrated, start):
    told, _ = calibrated(*CONSTANT_PHASE, start=start)
    assert 100 * told["rms_relative_error"] == pytest.approx(3.1, abs=0.05)
    assert told["values"]["phase_exponent"] == pytest.approx(0.92, abs=0.005)
    assert told["noise"]["source"] == "the residuals of the fit"
    assert all(told["identified"].values())


def test_by_default_it_fits_what_the_sweep_determines(calibrated):
    told, _ = calibrated()
    assert 100 * told["rms_relative_error"] < 3.1
    assert told["fixed"] == ["sheet_mismatch"]
    assert told["intervals_95"]["phase_exponent"][1] < 0.98


@pytest.mark.usefixtures("linear_intervals")
def test_why_the_ideal_line_cannot(calibrated):
    told, out = calibrated(*CONSTANT_PHASE)
    ideal = told["ideal_capacitance"]
    assert 100 * ideal["rms_relative_error"] == pytest.approx(8.2, abs=0.1)
    assert "has an rms error of Z of 8.2 %; with the exponent 0.922 it is 3.1 %" in out
    assert "the ideal model has the wrong curve" in out
    assert "the measured |Z| goes as f^-0.93 and Rs as f^-0.53" in out
