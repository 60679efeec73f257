"""Calibration by interfaces that are read at frequencies of their own."""

import json

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.fit import solve_from
from rcskin.simulator.calibration.fit_options import FitSpec
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.prior import priors
from rcskin.simulator.calibration.problem import LeastSquaresProblem, centered_model
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.models.parameters import own_values
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, write
from rcskin.simulator.sweeps.reading_subset import restricted

pytestmark = pytest.mark.usefixtures("models_made_once")

FREQUENCIES = np.geomspace(1e3, 2e5, 10).round(3).tolist()
TRUTH = {"sheet_resistance": 0.2, "capacitance": -0.25, "lead_resistance": 300.0}
NAMES = tuple(TRUTH)
PRESSES = ("none", "none", "none", "1,2", "2,1")
METER = {"magnitude_noise": 2e-3, "phase_noise": 2e-3, "magnitude_accuracy": 3e-3}


@pytest.fixture(scope="module")
def shared():
    changes = {
        "pixels": 2,
        "sweep.frequencies": FREQUENCIES,
        "readout": METER,
        "press": {"factor_spread": 0.05},
    }
    return load_scene("sheet-5x5-two-interfaces").with_(changes)


@pytest.fixture(scope="module")
def own(shared):
    """The first interface reads the upper part, so that its frequencies are not the scene's."""
    each = {
        "interface.1.frequencies": FREQUENCIES[3:],
        "interface.2.frequencies": FREQUENCIES[:8],
    }
    return shared.with_(each)


def problem_of(scene, sweeps):
    data, values = (
        measurements_of(scene.parts, sweeps),
        own_values(scene.parts.skin, scene.parts.setup),
    )
    known = priors(data, "wide")
    fixed = {name: value for name, value in values.items() if name not in NAMES}
    asked = FitSpec(data, scene.readout, {name: known[name] for name in NAMES}, fixed)
    return LeastSquaresProblem(asked, centered_model(scene.parts, {}, 1e-4))


def test_what_was_read_counts_as_ever_and_what_was_not_for_nothing(own, shared, read):
    whole = read(shared, TRUTH, PRESSES)
    parts = [
        problem_of(shared, restricted(whole, own.parts.setup.taken)),
        problem_of(shared, whole),
    ]
    u = 0.1 * np.random.default_rng(3).standard_normal(parts[0].bounds()[0].size)
    u[2] = 0.0  # of the lead, whose prior is as wide as what was read says
    kept = np.tile(own.parts.setup.taken.ravel(), 2 * len(parts[0].cells))
    (residuals, slopes), (all_residuals, all_slopes) = (
        (each.residuals(u)[: kept.size], each.jacobian(u)[: kept.size]) for each in parts
    )
    np.testing.assert_allclose(residuals[kept], all_residuals[kept], rtol=1e-9)
    assert not residuals[~kept].any() and not slopes[~kept].any()
    np.testing.assert_allclose(slopes[kept, :2], all_slopes[kept, :2], rtol=1e-9)
    assert parts[0].spec.measurements.numbers == 2 * own.parts.setup.taken.sum() * len(
        parts[0].cells
    )


def test_the_scene_may_say_other_frequencies_than_were_read(own, shared, read):
    """What was read counts: own or shared in the scene makes no difference."""
    sweeps = restricted(read(shared, TRUTH, PRESSES), own.parts.setup.taken)
    options = Options(fit=NAMES, fix=("others",))
    one, other = (calibrate(scene, sweeps, options) for scene in (own, shared))
    assert one.values == other.values and one.intervals == other.intervals
    assert one.scene.parts.setup.taken is not None and other.scene.parts.setup.taken is None


@pytest.mark.slow
def test_a_twin_is_determined_within_its_intervals_and_better_by_more_readings(
    own, shared, simulated
):
    truth = simulated(shared, TRUTH, PRESSES)
    random, trials, missed, wider = np.random.default_rng(2), 6, 0, []
    for _ in range(trials):
        sweeps = read_out(truth, Readout(**METER), random)
        options = Options(fit=NAMES, fix=("others",))
        part, whole = (
            calibrate(own, each, options)
            for each in (restricted(sweeps, own.parts.setup.taken), sweeps)
        )
        for name, value in TRUTH.items():
            low, high = part.intervals[name]
            missed += not low <= value <= high
            wider.append(np.diff(part.intervals[name]) / np.diff(whole.intervals[name]))
        assert 0.3 < part.chi_squared < 2
    assert missed <= 3
    assert np.mean(np.log(wider)) > 0


@pytest.mark.usefixtures("linear_intervals")
def test_noise_is_estimated_from_repeats_of_what_was_read(own, shared, simulated):
    bare = own.with_({"readout": {}})
    truth = restricted(simulated(shared, TRUTH, ["none"] * 12), own.parts.setup.taken)
    read = read_out(truth, Readout(**METER), np.random.default_rng(5))
    found = calibrate(bare, read, Options(fit=("capacitance",), fix=("others",)))
    assert found.noise.freedom == 11 * own.parts.setup.taken.sum()
    assert found.noise.readout.magnitude_noise == pytest.approx(2e-3, rel=0.2)


def test_an_interface_that_the_band_leaves_nothing_of_is_left_out(own, shared, read):
    sweeps = restricted(read(shared, TRUTH, PRESSES), own.parts.setup.taken)
    data = measurements_of(own.parts, sweeps, (FREQUENCIES[8] - 1, np.inf))
    assert [each.name for each in data.parts.setup.interfaces] == ["left"]
    assert data.parts.setup.taken is None and data.parts.setup.frequency.size == 2
    with pytest.raises(InputError, match="`band` must contain frequencies"):
        measurements_of(own.parts, sweeps, (1e7, np.inf))


@pytest.mark.usefixtures("linear_intervals", "unpainted")
def test_the_command_takes_them(own, shared, read, run, tmp_path, earth_alone):
    write(restricted(read(shared, TRUTH, PRESSES), own.parts.setup.taken), tmp_path / "own.nc")
    (tmp_path / "own.toml").write_text(scene_text(own), encoding="utf-8")
    asked = ("--fit", "capacitance", "--fit", "sheet_resistance", "-o", tmp_path / "out")
    code, out, err = run("calibrate", tmp_path / "own.toml", tmp_path / "own.nc", *asked)
    assert code == 0 and earth_alone(err) and "chi-squared" in out
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"calibrated.toml", "residuals-left.png", "residuals-bottom.png"} <= names
    again = load_scene(str(tmp_path / "out" / "calibrated.toml"))
    assert again.parts.setup.taken.tolist() == own.parts.setup.taken.tolist()
    for path in (tmp_path / "out").glob("*.json"):
        json.loads(path.read_text(), parse_constant=pytest.fail)


def test_a_solution_does_not_hang_on_what_stands_where_nothing_was_read(own, shared, read):
    problem = problem_of(shared, restricted(read(shared, TRUTH, PRESSES), own.parts.setup.taken))
    fit = solve_from(problem, {name: 0.0 for name in NAMES})
    for reading in problem.spec.measurements.sweeps:
        reading.Z[~own.parts.setup.taken] = 7 - 3j
    assert solve_from(problem, {name: 0.0 for name in NAMES}).u == pytest.approx(fit.u, rel=1e-12)
