"""Foam that creeps while a sweep is read, and remembers what pressed it."""

import itertools

import numpy as np
import pytest
from rcskin.simulator.inversion.touch_templates import templates
from rcskin.simulator.measure.foam_state import FoamState, reading_moments
from rcskin.simulator.measure.simulate import resimulated, simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, press_on
from rcskin.simulator.scene.scene_files import load_scene, write_scene
from rcskin.simulator.sweeps import InputError, concatenate, impedance, write
from rcskin.tests.refusals import refusal_of

ONE = [{"share": 0.1, "time_constant": 1.0}]
TWO = [*ONE, {"share": 0.05, "time_constant": 20.0}]
MECHANICS = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}
FOAM = {"skin.foam": {"thickness": 4e-3, "mechanics": MECHANICS, "relaxation": ONE}}
TWICE = [
    {"name": "there", "high": ["top-left"], "low": ["bottom-left"]},
    {
        "name": "back",
        "high": ["bottom-left"],
        "low": ["top-left"],
        "frequencies": [1105.0, 17685.0],
    },
]
SLOWLY = {"experiment.timing": {"averaging": 20}}


@pytest.fixture(scope="module")
def strip():
    return load_scene("strip-1x5")


@pytest.fixture(scope="module")
def creeping(strip):
    return strip.with_({"skin.foam.relaxation": ONE, **SLOWLY})


def pressed_foam(scene, text, seconds=0.0):
    """State of a foam that is unpressed at first and pressed after that time."""
    return FoamState(scene.parts.skin).then(press_on(scene.parts.skin, scene.press, text), seconds)


def strain(press):
    """Strain under its only touch, at constant permittivity."""
    (touch,) = press.touches
    return 1 - 1 / touch.factor


@pytest.mark.parametrize("t", [0.0, 0.5, 60.0])
def test_a_factor_creeps_in_strain(creeping, t):
    """e = (1 - 1 / factor) (1 + share (1 - exp(-t / time)))"""
    now = pressed_foam(creeping, "1,2:2.0").after(t)
    assert strain(now) == pytest.approx(0.5 * (1 + 0.1 * (1 - np.exp(-t))), rel=1e-12)


def test_a_released_press_leaves_a_trace_that_goes(creeping):
    left = pressed_foam(creeping, "1,2:2.0").then(Press(), 3.0)
    trace = 0.5 * 0.1 * (1 - np.exp(-3.0))
    assert strain(left.after(0.0)) == pytest.approx(trace, rel=1e-12)
    assert strain(left.after(2.0)) == pytest.approx(trace * np.exp(-2.0), rel=1e-12)
    assert left.after(25.0) == Press() and left.then(Press(), 25.0).spots == ()


def test_a_trace_adds_to_the_next_press_of_its_place_alone(creeping):
    state = pressed_foam(creeping, "1,2:2.0").then(Press(), 3.0)
    again = state.then(press_on(creeping.parts.skin, creeping.press, "1,2:1.5+1,4:1.5"), 1.0).after(
        0.0
    )
    here, there = again.touches
    trace = 0.05 * (1 - np.exp(-3.0)) * np.exp(-1.0)
    assert 1 - 1 / here.factor == pytest.approx(1 / 3 + trace, rel=1e-12)
    assert there.factor == 1.5


@pytest.mark.parametrize("text", ["1,2:0.7", "1,2:1.0"])
def test_what_is_not_compressed_does_not_creep(creeping, text):
    state = pressed_foam(creeping, text)
    assert state.after(9.0) == state.press
    assert state.then(Press(), 9.0).after(0.0) == Press()


def test_a_fixed_depth_stays_and_leaves_its_trace(strip):
    scene = strip.with_(FOAM)
    state = pressed_foam(scene, "1,2:2mm")
    assert state.after(7.0) == state.press
    (trace,) = state.then(Press(), 7.0).after(0.4).touches
    relaxed = 2e-3 * 0.1 / 1.1 * (1 - np.exp(-1.1 * 7.0))
    assert trace.by.value == pytest.approx(relaxed * np.exp(-0.4), rel=1e-12)


def test_a_force_creeps_from_the_depth_that_it_takes_at_once(strip):
    scene = strip.with_({**FOAM, "skin.foam.mechanics.stress_strain": "linear"})
    area = 20e-3 * 20e-3
    (touch,) = pressed_foam(scene, "1,2:3N").after(2.0).touches
    at_once = 3 / area / 30e3
    grown = at_once * 4e-3 * (1 + 0.1 * (1 - np.exp(-2.0)))
    assert touch.by.value == pytest.approx(grown, rel=1e-9)


def test_hysteresis_counts_as_a_press_is_lessened_and_not_let_go(strip):
    scene = strip.with_({"skin.foam.hysteresis": 0.2})
    up, down = (pressed_foam(scene, text) for text in ("1,2:1.5", "1,2:2.0"))
    less = down.then(press_on(scene.parts.skin, scene.press, "1,2:1.5"), 1.0)
    assert strain(up.after(5.0)) == pytest.approx(1 / 3, rel=1e-14)
    lagging = 1 / 3 + 3 * 0.2 / 3 * (1 - 2 / 3)
    assert strain(less.after(5.0)) == pytest.approx(lagging, rel=1e-12)
    pressed_anew = less.then(Press(), 1.0).then(
        press_on(scene.parts.skin, scene.press, "1,2:1.5"), 1.0
    )
    assert pressed_anew.after(0.0) == up.press


def test_a_state_is_the_same_through_any_change_that_is_none(creeping):
    press = press_on(creeping.parts.skin, creeping.press, "1,2:2.0+1,5:1.4")
    once = FoamState(creeping.parts.skin).then(press, 0.0)
    twice = once.then(press, 0.8)
    for one, other in zip(once.after(2.0).touches, twice.after(1.2).touches, strict=True):
        assert one.factor == pytest.approx(other.factor, rel=1e-13)


def test_readings_are_taken_one_after_the_other(strip):
    scene = load_scene("sheet-5x5-two-interfaces").with_(
        {"experiment.timing": {"before": 0.3, "speed": "SLOW"}, "sweep.frequencies": [40.0, 1e4]}
    )
    moments, whole = reading_moments(scene.parts)
    first = 0.3 + 0.02
    np.testing.assert_allclose(moments[0], [first + 0.05, first + 0.1 + 0.025])
    np.testing.assert_allclose(moments[1] - moments[0], 0.15 + 0.02)
    assert whole == pytest.approx(0.3 + 2 * (0.02 + 0.15))


def one_by_one(scene, texts):
    """The readable twin of sweeps in time: every reading solved by itself, at its moment."""
    solver, (moments, whole) = Solver(scene.parts, 1e-6), reading_moments(scene.parts)
    state, Z = FoamState(scene.parts.skin), []
    for text in texts:
        state = state.then(
            press_on(scene.parts.skin, scene.press, text), scene.experiment.timed.pause
        )
        readings = itertools.product(*map(range, moments.shape))
        Z.append(
            [
                solver.solve(state.after(moments[i, k]), scene.frequencies[k]).Z[i, 0]
                for i, k in readings
            ]
        )
        state = state.then(Press(), whole)
    return np.reshape(Z, (len(texts), *moments.shape))


@pytest.mark.parametrize(
    "changes",
    [
        {"skin.foam.relaxation": ONE, **SLOWLY},
        {"skin.foam.relaxation": TWO, "experiment.timing": {"averaging": 200}},
        {"skin.foam.relaxation": [{"share": 0.6, "time_constant": 1e-3}]},
        {**FOAM, **SLOWLY, "press": {"force": 1.0}},
        {"skin.foam.relaxation": ONE, "interface": TWICE, **SLOWLY},
    ],
)
def test_sweeps_in_time_are_their_readings_within_the_estimated_error(strip, changes):
    scene, texts = strip.with_(changes), ["1,1", "none", "1,1+1,4"]
    sweeps = simulate(
        Solver(scene.parts, 1e-4), [press_on(scene.parts.skin, scene.press, text) for text in texts]
    )
    Z, read = (
        impedance(sweeps),
        np.broadcast_to(scene.parts.setup.read, (3, *scene.parts.setup.shape)),
    )
    off = np.abs(Z - one_by_one(scene, texts))
    Rs_error, Cp_error = sweeps["Rs_error"].values, sweeps["Cp_error"].values
    allowed = Rs_error + Cp_error * 2 * np.pi * scene.frequencies * np.abs(Z) ** 2
    assert (off <= 2 * allowed + 1e-6 * np.abs(Z))[read].all()
    assert (Rs_error <= 1.01e-4 * np.abs(Z.real))[read].all()


def test_foam_that_creeps_not_at_all_reads_as_before(strip):
    """No key, hysteresis of released presses, or creep too slow to be observed."""
    presses = [press_on(strip.parts.skin, strip.press, text) for text in ("none", "1,1", "1,3")]
    plain = simulate(Solver(strip.parts), presses)
    for foam in ({"hysteresis": 0.1}, {"relaxation": [{"share": 1e-6, "time_constant": 1e7}]}):
        changes = {f"skin.foam.{key}": value for key, value in foam.items()}
        other = simulate(Solver(strip.with_(changes).parts), presses)
        np.testing.assert_allclose(impedance(other), impedance(plain), rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "texts", "message"),
    [
        (
            {"skin.foam.relaxation": [{"share": 0.99, "time_constant": 1.0}]},
            ["1,2:2.0"],
            "press 1,2:2.0: the foam would creep to 0.995 of its thickness; it must stay within "
            "0.99: press less",
        ),
        (
            {"skin.foam.relaxation": [{"share": 9.0, "time_constant": 1.0}]},
            ["1,2:1.05", "1,2:1.6"],
            "press 1,2:1.6: the foam would creep to 3.75",
        ),
        (FOAM, ["1,2:2.6mm"], ""),
        ({**FOAM, "press": {"force": 30.0}}, ["1,2"], "press 1,2:30.0N: the foam would creep to"),
        (
            {"skin.foam.relaxation": ONE},
            ["disc(0.05,0.01,0.005):2.0+disc(0.05,0.01,0.005):1.5"],
            "foam that creeps allows one touch at each place",
        ),
    ],
)
def test_presses_that_creep_too_far_are_refused(strip, changes, texts, message):
    scene = strip.with_(changes)
    presses = [press_on(scene.parts.skin, scene.press, text) for text in texts]
    if not message:  # a fixed depth stays
        assert simulate(Solver(scene.parts, 1e-2), presses).sizes["sweep"] == 1
        return
    assert message in refusal_of(simulate, Solver(scene.parts, 1e-2), presses)


def test_sweeps_are_simulated_again_in_their_order_session_by_session(creeping):
    """As a recording of two sessions has them: traces go from one sweep to the next of its own."""
    first, second = ["1,1:2.0", "none"], ["none", "1,3:1.5"]
    parts = [
        simulate(
            Solver(creeping.parts),
            [press_on(creeping.parts.skin, creeping.press, text) for text in texts],
        )
        for texts in (first, second)
    ]
    both = concatenate(
        [part.assign_coords(session=("sweep", [k, k])) for k, part in enumerate(parts)]
    )
    mixed = both.isel(sweep=[0, 2, 1, 3])
    again = resimulated(mixed, creeping.parts, creeping.frequencies)
    np.testing.assert_allclose(impedance(again), impedance(mixed), rtol=1e-12)
    assert list(again["press"].values) == list(mixed["press"].values)
    assert np.abs(impedance(again)[1] / impedance(again)[2] - 1).max() > 1e-3


@pytest.mark.parametrize(
    ("command", "what"),
    [
        (["limits", "SCENE", "-o", "limits"], "a limit"),
        (["frequencies", "SCENE", "-n", "2"], "a limit"),
        (["design", "SCENE", "-o", "designed"], "a design"),
        (["calibrate", "SCENE", "SWEEPS", "-o", "found"], "a calibration"),
        (["page", "SCENE", "-o", "page.html"], "a page"),
        (["study", "SCENE", "--vary", "pixels.columns=3,4", "-o", "study.csv"], "a study"),
    ],
)
def test_commands_that_take_presses_as_they_are_at_once_say_so(
    creeping, run, tmp_path, monkeypatch, command, what
):
    monkeypatch.chdir(tmp_path)
    write_scene("mine.toml", creeping)
    write(simulate(Solver(creeping.parts, 1e-2), [Press()]), "mine.nc")
    named = {"SCENE": "mine.toml", "SWEEPS": "mine.nc"}
    code, _, err = run(*(named.get(word, word) for word in command))
    message = f"strip-1x5: {what} cannot take `skin.foam.relaxation`"
    assert code == 2 and err.count(message) == 1 and "Traceback" not in err


def test_a_localizer_by_a_model_of_the_skin_says_so_too(creeping):
    with pytest.raises(InputError, match="a localizer by a model of the skin cannot take"):
        templates(creeping.parts, "column", "drawn")


@pytest.mark.parametrize(
    ("pause", "how"),
    [(2.0, "with a pause of 2 s before the next"), (0.0, "with no pause before the next")],
)
def test_sweep_says_how_presses_follow_each_other(creeping, run, tmp_path, monkeypatch, pause, how):
    monkeypatch.chdir(tmp_path)
    write_scene("mine.toml", creeping.with_({"experiment.timing.pause": pause}))
    code, _, err = run("sweep", "mine.toml", "--press", "1,2", "-o", "out.nc")
    assert code == 0
    (line,) = [line for line in err.splitlines() if "the foam creeps" in line]
    assert line.startswith("rcskin: note: mine.toml: the foam creeps: presses follow each other")
    assert line.endswith(f"each lasts 500 ms while it is read, {how}")
