"""Foam that creeps under a mounted skin."""

import numpy as np
import pytest
import rcskin
from rcskin.simulator.measure.foam_state import FoamState
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import press_on
from rcskin.simulator.sensor.foam_memory import FoamMemory

PERIOD = 0.015
"""Duration of a sweep of the strip, s."""
ONE = [{"share": 0.15, "time_constant": 0.05}]
TWO = [*ONE, {"share": 0.05, "time_constant": 2.0}]
FOAM = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}


def strip(**foam):
    changes = {f"skin.foam.{key}": value for key, value in foam.items()}
    timing = {"experiment.timing.pause": PERIOD}
    return rcskin.load("strip-1x3").with_({**timing, **changes})


def test_presses_in_turn_are_those_of_the_solver_in_time():
    scene = strip(relaxation=ONE, hysteresis=0.2)
    presses = ["1,2:1.9", "1,2:1.5", "none"]
    sensor = rcskin.Sensor(scene, noise=False, rtol=3e-3)
    for press in presses:
        sensor.step(press, PERIOD)
        sensor.step(None, PERIOD)
    solved = rcskin.sweep(scene, presses, rtol=1e-5)
    own = sensor.sweeps().isel(sweep=slice(0, 6, 2))
    for name in ("Rs", "Cp"):
        np.testing.assert_allclose(own[name].values, solved[name].values, rtol=3e-3)
    first, again = own.Cp.values[0, 0], rcskin.sweep(strip(), presses[:1]).Cp.values[0, 0]
    assert np.abs(first / again - 1).max() > 5e-3


CHANGES = [
    (["1,2:1.8"], 0.3),
    (["1,2:1.4", "1,3:1.5"], 0.1),
    (["1,2:0.8", "1,3:1.1"], 0.1),
    (["1,2:1.3"], 0.1),
    ([], 0.2),
    (["1,3:1.6"], 0.4),
]
CLOSING = {"thickness": 4e-3, "mechanics": FOAM, "capacitance_per_area": None}


@pytest.mark.parametrize(
    "foam",
    [
        {"relaxation": TWO},
        {"relaxation": ONE, "hysteresis": 0.3},
        {"relaxation": TWO, **CLOSING},
    ],
    ids=["two solids", "hysteresis", "closing pores"],
)
def test_cells_creep_as_touches_do(foam):
    scene = strip(**foam)
    state, memory, now = FoamState(scene.parts.skin), FoamMemory(scene.parts.skin, 3, 2), 0.0
    for touches, seconds in CHANGES:
        state = state.then(
            press_on(scene.parts.skin, scene.press, "+".join(touches) or "none"), now - state.since
        )
        memory.press(batch_of(state.press, 2), np.zeros(2, dtype=bool), now)
        for part in (0.0, 0.5):
            pressed = memory.pressed(now + part * seconds)
            for skin in range(2):
                np.testing.assert_allclose(
                    on_pixels(*pressed.one(skin)), on_pixels(*cells(state.after(part * seconds)))
                )
        now += seconds


def test_a_fixed_depth_keeps_its_strain_and_leaves_a_trace():
    scene = strip(relaxation=TWO, **CLOSING)
    depth = scene.parts.skin.pressed_depth(1.8)
    state = FoamState(scene.parts.skin).then(
        press_on(scene.parts.skin, scene.press, f"1,2:{1e3 * depth!r}mm"), 0.0
    )
    memory = FoamMemory(scene.parts.skin, 3, 1)
    memory.press(PressBatch.of([(np.array([1]), np.array([0.8]))]), np.ones(1, dtype=bool), 0.0)
    assert memory.pressed(0.4).rises == pytest.approx([0.8])
    state, left = (
        state.then(press_on(scene.parts.skin, scene.press, "none"), 0.5),
        np.zeros(1, dtype=bool),
    )
    memory.press(PressBatch.of([(np.zeros(0, dtype=np.int64), np.zeros(0))]), left, 0.5)
    (touch,) = state.after(0.1).touches
    assert memory.pressed(0.6).rises == pytest.approx(
        [scene.parts.skin.factor_at(touch.by.value) - 1], rel=1e-9
    )


def test_splitting_steps_changes_nothing_and_copies_are_apart():
    scene = strip(relaxation=ONE, hysteresis=0.2)
    whole, parts = (rcskin.Sensor(scene, skins=2, noise=False, rtol=3e-3) for _ in range(2))
    one = whole.step(["1,2:1.8", None], 0.1)
    for _ in range(10):
        parts.step(["1,2:1.8", None], 0.01)
    other = parts.copy()
    other.step("1,1:1.5", 0.05)
    np.testing.assert_array_equal(one.values, parts.step(None, 1e-9).values)
    np.testing.assert_array_equal(
        whole.step(None, 0.05).values, parts.step(None, 0.05 - 1e-9).values
    )


def test_foam_must_not_creep_beyond_its_greatest_strain():
    memory = FoamMemory(strip(relaxation=ONE).parts.skin, 3, 1)
    load = PressBatch.of([(np.array([0]), np.array([20.0]))])
    with pytest.raises(rcskin.InputError, match="would creep to 1.1 of its thickness"):
        memory.press(load, np.zeros(1, dtype=bool), 0.0)


def batch_of(press, skins):
    return PressBatch.of([cells(press)] * skins)


def cells(press):
    numbers = np.array([touch.column - 1 for touch in press.touches], dtype=np.int64)
    return numbers, np.array([touch.factor - 1 for touch in press.touches])


def on_pixels(numbers, rises):
    found = np.zeros(3)
    found[numbers] = rises
    return found


def test_a_skin_that_begins_again_alone_has_forgotten():
    scene = strip(relaxation=ONE)
    sensor = rcskin.Sensor(scene, skins=2, noise=False, rtol=3e-3)
    fresh = sensor.step(None, PERIOD).Cp[0]
    sensor.step("1,2:1.9", PERIOD)
    sensor.unpress([1])
    reading = sensor.step(None, PERIOD)
    np.testing.assert_allclose(reading.Cp[1], fresh, rtol=1e-9)
    assert (reading.Cp[0] / fresh - 1).max() > 1e-3
    assert np.isfinite(sensor.sweeps().Cp.values).all()
    with pytest.raises(rcskin.InputError, match=r"`skins` must be in 0\.\.1, got \[2\]"):
        sensor.unpress([2])
