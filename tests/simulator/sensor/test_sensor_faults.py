"""Sensors with faults against the full model of the faulty skin, from the start and in mid-run."""

import numpy as np
import pytest
from rcskin.simulator.measure.skin_faults import parse_fault
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sensor.sensor import Sensor
from rcskin.simulator.sweeps import InputError, impedance

SCENE = load_scene("strip-1x3").with_({"leads.stray_capacitance": 1e-12})
PRESS = "1,2:2"


def swept(sensor, press=PRESS):
    """Z of the latest whole sweep after a long step."""
    sensor.step(press, 100.0)
    return impedance(sensor.last_sweep)[0, 0]


def solved(fault, press=PRESS):
    parts = parse_fault(fault, SCENE.parts).changed(SCENE.parts)
    return Solver(parts, 1e-4).solve(press_on(parts.skin, parts.plan.press, press)).Z[0]


@pytest.mark.slow
def test_a_half_foil_reads_as_the_full_model_of_it():
    half = swept(Sensor(SCENE, noise=False, faults=("half foil top-left low",)))
    np.testing.assert_allclose(half, solved("half foil top-left low"), rtol=2e-3)


def test_a_stuck_spot_reads_as_a_touch_there():
    stuck = swept(Sensor(SCENE, noise=False, faults=("stuck spot 1,1:1.5",)))
    np.testing.assert_allclose(stuck, solved("aged gain 1 1", "1,1:1.5+1,2:2"), rtol=2e-3)


def test_a_foil_dies_and_a_reset_repairs_it():
    sensor = Sensor(SCENE, noise=False)
    healthy = swept(sensor)
    other = sensor.copy()
    sensor.fail("dead foil top-left")
    assert sensor.faults == ("dead foil top-left",) and other.faults == ()
    open_meter = 1 / (2j * np.pi * SCENE.frequencies * 1e-12)
    np.testing.assert_allclose(swept(sensor), open_meter, rtol=1e-3)
    np.testing.assert_allclose(swept(other), healthy, rtol=1e-12)
    sensor.reset()
    np.testing.assert_allclose(swept(sensor), healthy, rtol=1e-12)


def test_an_interface_is_open_once_all_its_foils_are_dead():
    own = load_scene("sheet-5x5-two-interfaces")
    (first, *_), names = own.interfaces, [each.name for each in own.contacts]
    tied = first.model_copy(update={"high": tuple(names[:2]), "low": tuple(names[2:3])})
    both = [parse_fault(f"dead foil {name}", own.parts) for name in names[:2]]
    scene = own.model_copy(update={"interfaces": (tied,)})
    one = both[0].changed(scene.parts)
    assert one.setup.interfaces[0].high == (names[1],) and both[1].changed(one) is None


def test_a_refused_fault_leaves_the_sensor_as_it_was():
    sensor = Sensor(SCENE, faults=("dead foil top-left",))
    with pytest.raises(InputError, match="must name one of"):
        sensor.fail("dead foil nowhere")
    sensor.fail("aged gain 2 2")
    assert sensor.faults == ("dead foil top-left", "aged gain 2 2")


def test_gains_age_on_drawn_skins_alike():
    given = {"session": "drawn", "noise": False, "skins": 2}
    sensor, aged = Sensor(SCENE, **given), Sensor(SCENE, **given, faults=("aged gain 0.9 1.1",))
    ratio = [impedance(each.last_sweep) for each in (aged, sensor) if each.step(PRESS, 100.0)]
    np.testing.assert_allclose((ratio[0] / ratio[1])[:, 0, [0, -1]], [[0.9, 1.1]] * 2, rtol=1e-12)


def test_a_fault_that_the_skin_cannot_have_is_refused():
    with pytest.raises(InputError, match="must name one of top-left, bottom-left"):
        Sensor(SCENE, faults=("dead foil right",))
    with pytest.raises(InputError, match="must be one of dead foil NAME"):
        Sensor(SCENE).fail("broken")
    with pytest.raises(InputError, match="`fault` must be a text, got 3"):
        Sensor(SCENE).fail(3)  # pyright: ignore[reportArgumentType]
