"""Student's t errors: a few readings far off neither move a fit nor widen its intervals."""

import json

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.calibration.student import ResidualBlock, StudentT, fitted_tail, likeliest
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import write
from rcskin.simulator.sweeps.schema import DIMENSIONS, impedance

TRUTH = {"sheet_resistance": 0.25, "capacitance": -0.3}
PRESSES = ("none", "none", "none", "1,2:2", "1,3:2")
TWO = Options(fit=tuple(TRUTH), fix=("others",))
TAIL = StudentT(3.0, 1.5)


def block_of(u):
    """Two sweeps of two readings, of which one is exact, one far off; curved in two unknowns."""
    r = np.array([[0.0, 40.0 + u[0], 0.0, u[1] ** 2], [u[0] * u[1], 1.0, 2.0, u[1]]])
    slopes = np.zeros((2, 4, 2))
    slopes[0, 1] = 1.0, 0.0
    slopes[0, 3] = 0.0, 2 * u[1]
    slopes[1, 0] = u[1], u[0]
    slopes[1, 3] = 0.0, 1.0
    columns = np.tile([0, 1], (2, 1))
    return ResidualBlock(np.arange(2), columns, 0, np.ones((2, 1, 2)), r, slopes)


def test_damped_residuals_have_the_squares_and_slopes_of_the_likelihood():
    u = np.array([0.3, -0.7])
    plain, damped = block_of(u), TAIL.damped(block_of(u))
    q = (plain.residuals.reshape(2, 2, 2) ** 2).sum(axis=1) / TAIL.scale**2
    rho = (TAIL.freedom + 2) * np.log(1 + q / TAIL.freedom)
    squares = (damped.residuals.reshape(2, 2, 2) ** 2).sum(axis=1)
    np.testing.assert_allclose(squares, rho, rtol=1e-12)
    for k in range(2):
        step = 1e-6 * np.eye(2)[k]
        ahead, behind = (TAIL.damped(block_of(u + side * step)) for side in (1, -1))
        slope = (ahead.residuals - behind.residuals) / 2e-6
        np.testing.assert_allclose(damped.slopes[..., k], slope, atol=1e-7)


@pytest.mark.parametrize("freedom", [2.0, 5.0])
def test_freedom_and_scale_are_found_from_many_residuals(freedom):
    random = np.random.default_rng(0)
    normal = random.standard_normal((20_000, 2))
    squares = 4 * (normal**2).sum(axis=1) / (random.chisquare(freedom, 20_000) / freedom)
    found = likeliest(squares, 40_000)
    assert found is not None
    assert found.freedom == pytest.approx(freedom, rel=0.1)
    assert found.scale == pytest.approx(2.0, rel=0.03)


def test_normal_residuals_are_called_normal():
    squares = (np.random.default_rng(0).standard_normal((100, 2)) ** 2).sum(axis=1)
    assert likeliest(squares, 195) is None
    assert fitted_tail(squares, 195).freedom > 10


def far_off(sweeps, share=0.02, seed=0):
    """Sweeps with a share of readings far off, two at least."""
    random, Z = np.random.default_rng(seed), impedance(sweeps)
    which = random.permutation(Z.size)[: max(2, round(share * Z.size))]
    off = np.zeros(Z.size, dtype=complex)
    off[which] = 0.4 * (random.choice([-1, 1], len(which)) + 1j)
    Z = Z * np.exp(off.reshape(Z.shape))
    return sweeps.assign(Rs=(DIMENSIONS, Z.real), X=(DIMENSIONS, Z.imag))


@pytest.fixture(scope="module")
def quiet(line):
    """The line, with a meter whose noise is to be estimated."""
    return line.with_({"readout": {"display_digits": 9}})


@pytest.mark.parametrize("stated", [True, False], ids=["noise stated", "noise estimated"])
def test_readings_far_off_do_not_move_a_fit(line, quiet, read, stated):
    sweeps = read(line, TRUTH, PRESSES, called=("none",) * 3 + ("1,2", "1,3"))
    scene = line if stated else quiet
    clean, normal, robust = (
        calibrate(
            scene, each, TWO if fit is None else Options(fit=TWO.fit, fix=TWO.fix, robust=fit)
        )
        for each, fit in ((sweeps, None), (far_off(sweeps), False), (far_off(sweeps), None))
    )
    assert clean.fit.spec.tail is None and normal.fit.spec.tail is None
    assert robust.fit.spec.tail is not None
    for name in TRUTH:
        low, high = robust.intervals[name]
        assert low < TRUTH[name] < high
        widths = [np.ptp(each.intervals[name]) for each in (clean, robust, normal)]
        assert widths[1] < 2 * widths[0] and widths[1] < widths[2]


@pytest.mark.slow
def test_intervals_hold_the_truth_of_twins_with_readings_far_off(line, read):
    held = []
    for seed in range(6):
        sweeps = far_off(read(line, TRUTH, PRESSES, seed), seed=seed)
        found = calibrate(line, sweeps, TWO)
        held += [low <= TRUTH[name] <= high for name, (low, high) in found.intervals.items()]
    assert sum(held) >= len(held) - 2


@pytest.mark.usefixtures("unpainted")
def test_the_report_states_the_distribution(run, tmp_path, line, read):
    (tmp_path / "skin.toml").write_text(scene_text(line))
    write(far_off(read(line, TRUTH, PRESSES)), tmp_path / "run.nc")
    names = "--fit", "sheet_resistance", "--fit", "capacitance", "--fix", "others"
    files = tmp_path / "skin.toml", tmp_path / "run.nc"
    code, out, _ = run("calibrate", *files, *names, "-o", tmp_path / "found")
    assert code == 0 and "Student's t distribution of" in out and "times the noise off, at" in out
    found = json.loads((tmp_path / "found" / "calibration.json").read_text())
    assert found["noise"]["degrees_of_freedom"] < 30
    code, out, _ = run("calibrate", *files, *names, "--no-robust", "-o", tmp_path / "normal")
    assert code == 0 and "Student" not in out
