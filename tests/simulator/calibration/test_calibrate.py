"""A known truth is recovered within the stated intervals, and what cannot be told is said so."""

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.estimates import quantile
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.misfit import gap_by_parameter
from rcskin.simulator.calibration.profile_distribution import NORMAL
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.models.parameters import own_values, parts_with
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.sweeps import InputError

TRUTH = {"sheet_resistance": 0.25, "capacitance": -0.3, "phase_exponent": 0.96}
FITTED = ("sheet_resistance", "capacitance", "stray_capacitance")
REST = ("none",) * 4


def only(names, **more):
    """Options to fit these parameters where all others are known."""
    return Options(fit=tuple(names), fix=("others",), **more)


def outside(found, truth):
    """Names of fitted parameters whose interval does not hold the truth."""
    return [
        name
        for name, (low, high) in found.intervals.items()
        if not low
        <= truth.get(name, own_values(found.scene.parts.skin, found.scene.parts.setup)[name])
        <= high
    ]


def test_what_the_data_determine_is_found(line, read):
    truth = TRUTH | {"lead_inductance": 4e-3, "stray_capacitance": 2e-12}
    found = calibrate(line, read(line, truth, REST))
    for name, value in truth.items():
        low, high = found.intervals[name]
        assert low < value < high
        assert found.identified[name] == (name != "sheet_resistance")
    assert found.intervals["lead_inductance"][0] > 0
    assert found.not_fitted == ("sheet_mismatch",)
    assert 0.5 < found.chi_squared < 1.6


@pytest.mark.usefixtures("linear_intervals")
def test_the_calibrated_scene_is_the_one_that_was_measured(line, read):
    found = calibrate(line, read(line, TRUTH, REST), Options(fit=tuple(TRUTH)))
    skin, true = found.scene.skin, parts_with(line.parts, TRUTH).skin
    assert skin.top.sheet_resistance == pytest.approx(true.top.sheet_resistance, rel=0.02)
    assert skin.foam.capacitance_per_area == pytest.approx(
        true.foam.unpressed_capacitance_per_area, rel=0.02
    )
    assert found.scene.sweep == line.sweep
    assert [each.name for each in found.quantities][:5] == [
        "top sheet",
        "bottom sheet",
        "both in series",
        "top over bottom",
        "foam capacitance",
    ]
    assert found["foam capacitance"].value == skin.foam.capacitance_per_area
    with pytest.raises(InputError, match="no quantity 'foam', only top sheet"):
        found["foam"]


TOLD = {"sheet_resistance": 0.05, "capacitance": -0.03, "stray_capacitance": 6e-12}


def intervals(line, simulated, trials):
    """Of readings of a skin of TOLD, drawn anew."""
    sweeps, random = simulated(line, TOLD, ("none",)), np.random.default_rng(1)
    readings = [read_out(sweeps, line.readout, random) for _ in range(trials)]
    return [calibrate(line, each, only(FITTED)) for each in readings]


def test_errors_are_as_large_as_the_intervals_say(line, simulated):
    """Half of a 95 % interval is 1.96 deviations; 40 draws tell a deviation to 11 %."""
    found = [each.intervals for each in intervals(line, simulated, 40)]
    for name in FITTED:
        low, high = np.array([each[name] for each in found]).T
        deviations = 1.96 * (low + high - 2 * TOLD[name]) / (high - low)
        assert 0.75 < np.sqrt(np.mean(deviations**2)) < 1.25


@pytest.mark.slow
def test_intervals_cover_the_truth_as_often_as_they_say(line, simulated):
    trials = 200
    missed = [outside(each, TOLD) for each in intervals(line, simulated, trials)]
    for name in FITTED:
        covered = trials - sum(name in each for each in missed)
        assert 0.91 <= covered / trials <= 0.995


def test_presses_are_used_and_their_strengths_found(line, read):
    presses = (*REST, "1,1:1.85", "1,2:2.12", "1,3:2.0")
    called = (*REST, "1,1", "1,2", "1,3")
    sweeps = read(line, TRUTH, presses, called=called)
    options = Options(fit=tuple(TRUTH))
    found, rest = (calibrate(line, each, options) for each in (sweeps, sweeps.isel(sweep=slice(4))))
    rises = np.concatenate(found.strengths)
    np.testing.assert_allclose(rises, [0.85, 1.12, 1.0], atol=0.03)
    for name in TRUTH:
        widths = [np.ptp(each.intervals[name]) for each in (found, rest)]
        assert widths[0] < widths[1]
    assert not outside(found, TRUTH)


@pytest.mark.usefixtures("linear_intervals")
def test_strengths_taken_as_stated_are_not_fitted(line, read):
    sweeps = read(line, TRUTH, (*REST, "1,2:2.0"))
    found = calibrate(line, sweeps, Options(fit=tuple(TRUTH), fixed_strength=True))
    assert found.strengths[1].tolist() == [1.0]
    assert found.fit.spec.touch_count == 0


@pytest.mark.usefixtures("linear_intervals")
def test_sheets_of_one_field_are_determined_only_together(line, read):
    found = calibrate(line, read(line, TRUTH, REST), only(("sheet_resistance", "sheet_mismatch")))
    assert not found.identified["sheet_mismatch"]
    assert "sheet_mismatch" in found.unclear[0]
    assert "the data identify only both sheets in series" in found.unclear[0]
    assert abs(found.values["sheet_mismatch"]) < 2


@pytest.mark.usefixtures("linear_intervals")
def test_a_parameter_without_any_effect_is_named(make_scene, line, read):
    scene = line.model_copy(update={"skin": make_scene(top=4e4, bottom=4e4).skin})
    found = calibrate(scene, read(scene, TRUTH, REST), only(("capacitance", "sheet_mismatch")))
    assert found.unclear == ("sheet_mismatch: not identified by the data; prior kept",)
    assert found.values["sheet_mismatch"] == pytest.approx(0, abs=1e-6)


def test_at_high_frequency_only_a_ratio_is_determined(line, read):
    scene = line.model_copy(
        update={"sweep": line.sweep.model_copy(update={"frequencies": (3e7, 5e7, 1e8, 2e8)})}
    )
    found = calibrate(scene, read(scene, presses=REST), only(("sheet_resistance", "capacitance")))
    assert found.unclear == (
        "capacitance and sheet_resistance: the data identify only their ratio",
    ) or (
        found.unclear == ("sheet_resistance and capacitance: the data identify only their ratio",)
    )


def test_films_and_leads_of_a_line_are_determined_only_together(make_scene, line, read):
    films = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 120.0}}
    scene = line.model_copy(update={"contacts": make_scene(films).contacts})
    sweeps = read(scene, {"contact_resistance": 0.3}, REST)
    fitted = ("sheet_resistance", "capacitance", "contact_resistance", "lead_resistance")
    found = calibrate(scene, sweeps, only(fitted))
    assert not (found.identified["lead_resistance"] or found.identified["contact_resistance"])
    assert any("contact_resistance and lead_resistance" in each for each in found.unclear)
    assert not outside(found, {"contact_resistance": 0.3})


def test_repeats_at_rest_give_the_noise_where_the_scene_does_not(line, read):
    silent = line.model_copy(update={"readout": Readout(display_digits=9)})
    meter = Readout(magnitude_noise=4e-3, phase_noise=1e-3, display_digits=9)
    found = calibrate(
        silent, read(silent, TRUTH, REST * 4, readout=meter), Options(fit=tuple(TRUTH))
    )
    assert found.noise.source == "16 sweeps of the unpressed skin"
    assert found.noise.readout.magnitude_noise == pytest.approx(4e-3, rel=0.15)
    assert found.noise.readout.phase_noise == pytest.approx(1e-3, rel=0.15)


def test_residuals_give_the_noise_where_nothing_else_does(line, read):
    silent = line.model_copy(update={"readout": Readout(display_digits=9)})
    meter = Readout(magnitude_noise=3e-3, phase_noise=3e-3, display_digits=9)
    found = calibrate(silent, read(silent, TRUTH, readout=meter), Options(fit=tuple(TRUTH)))
    assert found.noise.source == "the residuals of the fit"
    assert found.noise.readout.magnitude_noise == pytest.approx(3e-3, rel=0.4)
    assert not outside(found, TRUTH)


def test_errors_grow_where_the_model_does_not_follow(line, read):
    sweeps = read(line, {"phase_exponent": 0.97}, REST)
    options = only(("sheet_resistance", "capacitance"))
    wrong, right = (calibrate(line, each, options) for each in (sweeps, read(line, {}, REST)))
    assert wrong.chi_squared > 20
    ratio = np.ptp(wrong.intervals["capacitance"]) / np.ptp(right.intervals["capacitance"])
    found = wrong.information
    assert found.correlated > 3 and found.scale > 3 * wrong.chi_squared
    expected = found.scale**0.5 * quantile(found.independent) / NORMAL
    assert ratio == pytest.approx(expected, rel=0.3)


@pytest.mark.usefixtures("linear_intervals")
def test_why_an_ideal_capacitance_does_not_do(line, read):
    found = calibrate(line, read(line, TRUTH, REST), Options(fit=tuple(TRUTH)))
    assert found.ideal is not None
    assert found.ideal.ideal_rms_error > 3 * found.ideal.rms_error
    assert found.ideal.ideal.values["phase_exponent"] == 1
    assert "wrong curve" in found.ideal.sentences[1]


def test_the_scenes_own_draws_can_be_the_prior(line, read):
    sweeps = read(line, {"sheet_resistance": 0.05})
    wide, drawn = (
        calibrate(line, sweeps, Options(fit=("sheet_resistance", "capacitance"), prior=kind))
        for kind in ("wide", "session")
    )
    assert np.ptp(drawn.intervals["capacitance"]) < np.ptp(wide.intervals["capacitance"])
    with pytest.raises(InputError, match="lead_inductance is known"):
        calibrate(line, sweeps, Options(fit=("lead_inductance",), prior="session"))


def test_sheets_far_from_the_scene_are_found_by_training_anew(make_scene, read):
    scene = make_scene(rows=2, columns=2, frequencies=(1e3, 1e4, 5e4, 2e5))
    meter = Readout(magnitude_noise=2e-3, phase_noise=2e-3, display_digits=9)
    scene = scene.model_copy(update={"readout": meter})
    truth = {"sheet_resistance": 1.6, "capacitance": -0.2}
    found = calibrate(scene, read(scene, truth, (*REST, "1,2:2")), Options(fit=tuple(truth)))
    assert any("retraining it" in each for each in found.remarks)
    assert not outside(found, truth)
    assert found.fit.certificate < 0.2 * 2e-3


def test_sheets_of_two_fields_are_distinguished_by_two_interfaces(make_scene, read):
    contacts = {"top-left": {}, "bottom-bottom": {}, "top-right": {}}
    ways = {"one": ("top-left", "bottom-bottom"), "other": ("top-right", "bottom-bottom")}
    scene = make_scene(contacts, ways, frequencies=(1e3, 2e4, 2e5))
    meter = Readout(magnitude_noise=2e-3, phase_noise=2e-3, display_digits=9)
    scene = scene.model_copy(update={"readout": meter})
    truth = {"sheet_resistance": -0.1, "sheet_mismatch": 0.3, "capacitance": 0.1}
    sweeps = read(scene, truth, REST)
    model = Forward(scene.parts)
    found = calibrate(scene, sweeps, only(truth), model=model)
    assert not outside(found, truth)
    assert found.identified["sheet_mismatch"]
    best = gap_by_parameter(scene.parts, sweeps, model=model).alone[0]
    assert best.removed > 0.3


@pytest.mark.parametrize(
    ("name", "value"), [("sheet_resistance", 0.2), ("phase_exponent", 0.95), ("capacitance", 0.1)]
)
def test_the_parameter_that_differs_explains_the_gap(line, read, name, value):
    found = gap_by_parameter(line.parts, read(line, {name: value}, REST)).alone
    assert found[0].name == name
    assert found[0].value == pytest.approx(value, rel=0.2)
    assert found[0].removed > 0.9
    assert all(first.after <= second.after for first, second in zip(found, found[1:], strict=False))


def test_frequencies_are_those_of_the_sweeps(line, read):
    other = line.model_copy(
        update={"sweep": line.sweep.model_copy(update={"frequencies": (2e3, 1e4, 9e4)})}
    )
    found = calibrate(line, read(other, TRUTH, REST), Options(fit=tuple(TRUTH)))
    assert found.fit.spec.measurements.parts.setup == other.parts.setup
    assert found.scene.sweep == line.sweep
    assert not outside(found, TRUTH)


def test_only_the_band_and_the_session_asked_for_count(line, read):
    sweeps = read(line, TRUTH, REST)
    sweeps["session"] = ("sweep", np.array([1, 1, 2, 2]))
    found = calibrate(line, sweeps, Options(fit=tuple(TRUTH), band=(2e3, 1e5), session=2))
    f = found.fit.spec.measurements.parts.setup.frequency
    assert 2e3 <= f[0] < f[-1] <= 1e5
    assert found.fit.spec.measurements.sessions == [2]


def test_presses_that_are_no_pixels_are_left_out(line, read):
    presses = ("none", "rect(0.05,0.04,0.02,0.08):2", "1,2:2")
    sweeps = read(line, TRUTH, presses, called=("none", presses[1], "a thumb"))
    found = calibrate(line, sweeps, Options(fit=("capacitance",)))
    assert [each.press.touches for each in found.fit.spec.measurements.sweeps] == [()]
    assert "only whole pixels" in found.remarks[0]
    assert "a thumb" in found.remarks[1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fit": ("bulk",)}, "`fit` must be one of sheet_resistance.*'bulk'"),
        ({"fit": ("contact_resistance",)}, "contact_resistance has no effect in this scene"),
        ({"fit": ("capacitance",), "fix": ("capacitance",)}, "both fitted and fixed"),
        ({"fix": ("others",)}, "`fix` must be one of sheet_resistance.*'others'"),
        ({"band": (1.0, 2.0)}, "`band` must contain frequencies of the sweeps, 1000 to 200000 Hz"),
        ({"session": 7}, "`session` must be one of 0, got 7"),
    ],
)
def test_what_cannot_be_asked_is_reported(line, read, options, message):
    with pytest.raises(InputError, match=message):
        calibrate(line, read(line), Options(**options))


def test_an_interface_without_a_name_is_the_scenes_only_one(line, read):
    sweeps = read(line)
    unnamed = sweeps.assign_coords(interface=["unnamed"])
    both = (measurements_of(line.parts, each) for each in (unnamed, sweeps))
    one, other = (each.parts for each in both)
    assert one == other


def test_interfaces_must_be_the_scenes(line, read):
    sweeps = read(line).assign_coords(interface=["elsewhere"])
    with pytest.raises(InputError, match="interface 'elsewhere'; scene has meter"):
        calibrate(line, sweeps)


def test_a_model_of_other_frequencies_is_refused(line, read, make_scene):
    with pytest.raises(InputError, match="the model's sweep differ from"):
        calibrate(line, read(line), model=Forward(make_scene(columns=3).parts))
    with pytest.raises(InputError, match="`cells_per_pixel` of the model must be 1, got 2"):
        calibrate(line, read(line), model=Forward(line.parts, 2))


def test_what_is_fixed_though_unknown_widens_the_intervals(line, read):
    sweeps, fit = read(line, {"phase_exponent": 0.98}, REST), ("capacitance",)
    held, known = (calibrate(line, sweeps, each) for each in (Options(fit=fit), only(fit)))
    assert held.values["capacitance"] == known.values["capacitance"]
    assert np.ptp(held.intervals["capacitance"]) > 2 * np.ptp(known.intervals["capacitance"])
    assert "phase_exponent" in held.not_fitted and not known.not_fitted
