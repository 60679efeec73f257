"""A virtual meter whose skin creeps by the meter's own clock."""

import asyncio

import numpy as np
import pytest
from rcskin.hardware.virtual.hioki import VirtualHioki
from rcskin.hardware.virtual.instrument import answer
from rcskin.hardware.virtual.measurement import MeasurementSetup
from rcskin.hardware.virtual.meter_server import ControlPort
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.hardware.virtual.serving import press_by_script
from rcskin.simulator.measure.specimen import Specimen
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

CREEP = {"skin.foam.relaxation": [{"share": 0.1, "time_constant": 1.0}]}
READ = ":MEAS:VAL 2;:MEAS:ITEM 0,18;:FREQ 1105;:TRIG EXT;*TRG;:MEAS?"


class Clocked(VirtualHioki):
    """A meter whose clock is set by hand."""

    clock = 100.0

    @property
    def now(self):
        return self.clock


@pytest.fixture
def creeping():
    return load_scene("strip-1x5").with_(CREEP)


@pytest.fixture
def clocked(creeping):
    """A meter at the left of a strip that creeps, and a control of it."""
    meter = Clocked(
        MeasurementSetup(Specimen(creeping.parts, "left"), exact_readout, read_table()), pace=0.0
    )
    yield meter, ControlPort(meter)
    meter.worker.shutdown()


def read(scene, press):
    """(Rs, X) in ohm, by the solver alone."""
    Z = Solver(scene.parts).solve(press_on(scene.parts.skin, scene.press, press), 1105.0).Z[0, 0]
    return pytest.approx([Z.real, Z.imag], rel=1e-5)


def test_a_held_press_drifts_and_a_released_one_leaves_a_trace(clocked, creeping):
    meter, control = clocked

    async def session():
        readings = []
        for press, seconds in (("1,2:2.0", 0.0), ("1,2:2.0", 3.0), ("none", 0.0), ("none", 40.0)):
            if press != meter.press:
                await control.press(press)
            meter.clock += seconds
            readings.append(list(map(float, (await answer(meter, READ)).split(","))))
        return readings

    at_once, later, released, at_rest = asyncio.run(session())
    crept, trace = 0.5 * (1 + 0.1 * (1 - np.exp(-3))), 0.05 * (1 - np.exp(-3))
    assert at_once == read(creeping, "1,2:2.0")
    assert later == read(creeping, f"1,2:{float(1 / (1 - crept))!r}")
    assert released == read(creeping, f"1,2:{float(1 / (1 - trace))!r}")
    assert at_rest == read(creeping, "none")
    assert meter.press == "none"


def test_a_reading_is_of_the_middle_of_its_time(clocked):
    """Of a foam that creeps, what is triggered is pressed as half of the measurement later."""
    meter, control = clocked
    meter.pace, meter.settings.trigger = 400.0, "EXTERNAL"  # 2 s a reading at 1 kHz

    async def triggered():
        await control.press("1,2:2.0")
        await meter.trigger()
        return meter.pending.points[0][0]

    (touch,) = asyncio.run(triggered()).touches
    crept = 0.5 * (1 + 0.1 * (1 - np.exp(-1)))
    assert 1 - 1 / touch.factor == pytest.approx(crept, rel=1e-12)


def test_a_press_that_creeps_too_far_is_refused_and_the_one_before_stays(clocked):
    meter, control = clocked

    async def pressed():
        await control.press("1,2:2.0")
        with pytest.raises(InputError, match="the foam would creep to"):
            await control.press("1,3:80")
        return meter.press

    assert asyncio.run(pressed()) == "1,2:2.0"


def test_a_script_goes_on_after_a_press_that_creeps_too_far(clocked):
    meter, control = clocked
    told = []
    meter.report_failure = told.append
    asyncio.run(press_by_script([(0.0, "1,2:2.0"), (0.0, "1,3:80"), (0.0, "1,1:1.5")])(control))
    assert meter.press == "1,1:1.5"
    assert len(told) == 1 and "press 1,3:80.0: the foam would creep to" in told[0]


def test_both_interfaces_know_what_pressed_the_skin(creeping):
    foils = {"name": "back", "high": ["bottom-left"], "low": ["top-left"]}
    scene = creeping.with_({"interface": [*creeping.model_dump()["interfaces"], foils]})
    one = Specimen(scene.parts, "left")
    other = one.at("back")
    one.hold("1,2:2.0", 5.0)
    other.hold("none", 8.0)
    (trace,) = one.momentary("none", 8.0).touches
    assert trace == other.momentary("none", 8.0).touches[0]
    assert 1 - 1 / trace.factor == pytest.approx(0.05 * (1 - np.exp(-3)))
