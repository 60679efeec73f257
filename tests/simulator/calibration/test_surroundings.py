"""A body, the rim and a finger: fitted where a scene has them, and tried where it has not."""

import re
from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.calibration import surroundings_trials
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.misfit import gap_by_parameter
from rcskin.simulator.calibration.problem import model_of
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.calibration.surroundings_trials import largest_changes, with_effects
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import EFFECTS
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.sweeps import InputError, build

RIMS = ("mutual", "top", "bottom")
REST, PRESSED = ("none",) * 3, ("1,1:2.0", "1,2:2.0", "1,3:2.0")
FEW = {"sweep.frequencies": np.geomspace(2e3, 2e5, 5).tolist()}
TWINS = {
    "body": {"surroundings": {"body": {"distance": 6e-3}}},
    "finger": {"surroundings": {}, "press.finger": 5.3e-12},
    "rim": {"surroundings": {"rim": dict.fromkeys(RIMS, 12e-12)}},
    "sheet": {"skin.top.sheet_resistance": 65e3},
    "body and rim": {
        "surroundings": {"body": {"distance": 6e-3}, "rim": dict.fromkeys(RIMS, 12e-12)}
    },
    "all": {
        "surroundings": {"body": {"distance": 6e-3}, "rim": dict.fromkeys(RIMS, 4e-12)},
        "press.finger": 3e-12,
    },
}


@pytest.fixture(scope="module")
def scene(line):
    return line.with_(FEW)


@pytest.fixture(scope="module")
def model(scene):
    """Of the scene with all of them, trained once for all that is asked here."""
    found = model_of(with_effects(scene.parts, EFFECTS), 1e-4)
    known = found.reduced
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "rcskin.simulator.calibration.problem.reduced_for",
            lambda parts, *given, **more: replace(known, parts=parts),
        )
        yield found


@pytest.fixture(scope="module")
def twins(scene):
    """What a meter reads of other skins by the full solver, called as who presses calls it."""
    found, called = {}, (*REST, *PRESSED)
    for name, changes in TWINS.items():
        twin = scene.with_(changes)
        sweeps = simulate(
            Solver(twin.parts, 1e-4),
            [press_on(twin.parts.skin, twin.press, press) for press in called],
        )
        sweeps["press"] = ("sweep", np.array(called, dtype=object))
        found[name] = read_out(sweeps, scene.readout, np.random.default_rng(0))
    return found


@pytest.mark.parametrize(
    ("twin", "words", "truth"),
    [
        ("body", "a body at about ([0-9.]+) mm", 6.0),
        ("finger", "a finger of about ([0-9.]+) pF", 5.3),
    ],
)
def test_what_surrounds_a_twin_explains_its_gap(scene, model, twins, twin, words, truth):
    causes = gap_by_parameter(scene.parts, twins[twin])
    first, second, *_ = causes.alone
    assert first.name == twin
    assert float(re.fullmatch(words, first.description)[1]) == pytest.approx(truth, rel=0.05)
    assert first.removed > 0.99
    assert first.after < 0.2 * second.after
    assert causes.together == ()


def test_fingers_are_rods_where_the_scene_has_no_earth(scene):
    twin = scene.with_({"surroundings": {}})
    sweeps = simulate(
        Solver(twin.parts, 1e-4), [press_on(twin.parts.skin, twin.press, "1,2:2.0:5.3pF")]
    )
    (reading,) = (found := measurements_of(scene.parts, sweeps)).sweeps
    assert [str(touch) for touch in reading.press.touches] == ["1,2:2.0"]
    assert found.left_out == ("fingers of presses, because scene has no [surroundings]",)
    (reading,) = measurements_of(twin.parts, sweeps).sweeps
    assert reading.press.touches[0].finger == 5.3e-12


def test_the_gap_of_a_twin_of_another_sheet_is_not_what_surrounds_it(scene, model, twins):
    found = gap_by_parameter(scene.parts, twins["sheet"]).alone
    assert found[0].name in ("sheet_resistance", "sheet_mismatch")
    first_effect = next(each for each in found if each.name in EFFECTS)
    assert found[0].after < 0.2 * first_effect.after


def test_a_body_and_a_rim_are_found_together_where_each_alone_is_not_enough(scene, model, twins):
    causes = gap_by_parameter(scene.parts, twins["body and rim"])
    both, *others = causes.together
    words = dict(zip(both.names, both.descriptions, strict=True))
    assert {*words} == {"body", "rim"}
    body, rim = (float(re.search("[0-9.]+", words[name])[0]) for name in ("body", "rim"))
    assert (body, rim) == (pytest.approx(6, rel=0.05), pytest.approx(12, rel=0.1))
    assert both.after < 0.5 * min(each.after for each in (*causes.alone, *others))
    assert {each.name for each in causes.alone[:2]} != {*both.names}


def test_what_surrounds_a_skin_and_cannot_be_tried_is_a_remark(scene, twins, monkeypatch):
    def refuse(*given):
        raise InputError("the foam is unknown")

    monkeypatch.setattr("rcskin.simulator.calibration.misfit.Trials", refuse)
    causes = gap_by_parameter(scene.parts, twins["body"])
    assert causes.remarks == ("surroundings of the skin were not tried: the foam is unknown",)
    assert causes.together == () and len(causes.alone) > 3


@pytest.mark.parametrize(
    ("twin", "words", "truth"),
    [
        ("body", "a body at about ([0-9.]+) mm", 6.0),
        ("rim", "a rim of about ([0-9.]+) pF/m", 12.0),
        ("finger", "a finger of about ([0-9.]+) pF", 5.3),
    ],
)
def test_a_calibration_says_what_surrounds_a_twin_without_a_trained_model(
    scene, twins, monkeypatch, twin, words, truth
):
    monkeypatch.setattr(surroundings_trials, "centered_model", None)
    found = calibrate(scene, twins[twin], Options(fit=("stray_capacitance",)))
    assert found.chi_squared > 5
    (gained, *_) = [line for line in found.remarks if "`also`" in line]
    told = re.match(words + " in addition would reduce chi-squared .* to ([0-9.]+); fit", gained)
    assert float(told[1]) == pytest.approx(truth, rel=0.05)
    assert float(told[2]) == pytest.approx(1, abs=0.7)
    assert gained.endswith(f"; fit it with `also` {twin}")
    assert found.scene.surroundings is None


@pytest.mark.parametrize(
    "changes",
    [
        {"surroundings": {"body": {"distance": 8e-3 / 30}}},
        {"surroundings": {"rim": dict.fromkeys(RIMS, 150e-12)}},
        {"surroundings": {}, "press.finger": 30e-12},
    ],
    ids=["body", "rim", "finger"],
)
@pytest.mark.parametrize("leads", [{}, {"resistance": 2e5, "inductance": 0.1}], ids=str)
def test_no_effect_is_larger_than_its_bound(scene, changes, leads):
    scene = scene.with_({"leads": leads, "surroundings": {}})
    there, without = (
        Solver(each.parts, 1e-4).solve(press_on(each.parts.skin, each.press, "1,2:2.0")).Z
        for each in (scene.with_(changes), scene)
    )
    assert (
        np.abs(there / without - 1)
        <= largest_changes(scene.parts.skin, scene.parts.setup, without, 1)
    ).all()


def test_effects_under_the_noise_are_not_tried(scene, monkeypatch):
    """A line of 1e5 times the capacitance behind leads; its misfit is that of a constant phase."""
    foam, sheet = scene.skin.foam, scene.skin.top
    heavy = scene.with_(
        {
            "skin.foam.capacitance_per_area": 1e5 * foam.unpressed_capacitance_per_area,
            "skin.sheet_resistance": sheet.sheet_resistance / 1e5,
            "leads.resistance": 100.0,
        }
    )
    twin = heavy.with_({"skin.foam.phase_exponent": 0.9})
    sweeps = simulate(
        Solver(twin.parts, 1e-4), [press_on(twin.parts.skin, twin.press, press) for press in REST]
    )
    monkeypatch.setattr(surroundings_trials, "PlainEffects", None)
    found = calibrate(heavy, sweeps, Options(fit=("capacitance",)))
    assert found.chi_squared > 2
    assert any("would change these readings by far less" in line for line in found.remarks)


def test_what_surrounds_a_skin_is_fitted_where_that_is_asked_for(scene, model, twins):
    options = Options(fit=("capacitance",), fix=("others",), also=EFFECTS)
    found = calibrate(scene, twins["all"], options, model=model)
    assert 0.3 < found.chi_squared < 2
    told = {each.name: each for each in found.quantities}
    truth = {"body, bottom": 6e-3, "rim, top": 4e-12, "finger": 3e-12}
    for name, unit in zip(truth, ("m", "F/m", "F"), strict=True):
        assert told[name].low < truth[name] < told[name].high
        assert (told[name].unit, told[name].source) == (unit, "data")
    around = found.scene.surroundings
    assert around.body[0].distance == pytest.approx(told["body, bottom"].value)
    assert around.rim.top == pytest.approx(told["rim, top"].value)
    assert found.scene.press.finger == pytest.approx(told["finger"].value)


def test_a_finger_without_a_press_is_not_identified(scene, model, twins):
    around = with_effects(scene.parts, EFFECTS).scene
    rest = twins["all"].isel(sweep=slice(len(REST)))
    found = calibrate(around, rest, Options(fit=("body", "finger"), fix=("others",)), model=model)
    assert "finger: not identified by the data; prior kept" in found.unclear
    assert not found.identified["finger"]


def test_a_model_of_other_surroundings_is_refused(scene, model, twins):
    with pytest.raises(InputError, match="the model's surroundings differ from the measured ones"):
        calibrate(scene, twins["body"], Options(also=("body",)), model=model)


def test_intervals_hold_the_truth(scene, model):
    """Twins of any body, rim and finger by the same model, read by the meter: 95 % intervals."""
    random, around = np.random.default_rng(3), model.parts.scene
    names = (*EFFECTS, "capacitance")
    held = []
    for _ in range(3):
        truth = dict(zip(names, random.normal(0, 0.2, len(names)), strict=True))
        truth["finger"] = random.uniform(1e-12, 8e-12)
        cells = [
            model.cells(press_on(around.parts.skin, around.press, press))
            for press in (*REST, *PRESSED)
        ]
        Z = np.stack([model.slopes(each, truth).Z for each in cells])
        sweeps = build(
            Z,
            around.frequencies,
            interface=[each.name for each in around.interfaces],
            press=[*REST, *PRESSED],
            row=[0, 0, 0, 1, 1, 1],
            column=[0, 0, 0, 1, 2, 3],
            session=[0] * 6,
            attributes={},
        ).dataset()
        found = calibrate(
            around,
            read_out(sweeps, around.readout, random),
            Options(fit=names, fix=("others",)),
            model=model,
        )
        held += [low < truth[name] < high for name, (low, high) in found.intervals.items()]
    assert len(held) == 3 * len(names)
    assert np.mean(held) >= 0.85


@pytest.mark.parametrize(
    ("around", "also", "told"),
    [
        (
            None,
            "bodies",
            "`also` must be one of body, rim, finger, leak, source_scale, .*'bodies'",
        ),
        (
            None,
            "series_resistance",
            r"cannot have series_resistance: no \[\[interface\]\] has reader",
        ),
        ("solved", "body", "cannot have body: it needs .surroundings.body., not solved"),
        ({"body": {"side": "top", "distance": 5e-3}}, "finger", "cannot have finger: it needs"),
    ],
)
def test_what_a_scene_cannot_have_is_refused(scene, around, also, told):
    given = scene.with_({"surroundings": around}) if around else scene
    with pytest.raises(InputError, match=told):
        with_effects(given.parts, (also,))
