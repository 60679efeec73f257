"""A measured sweep is sound, or it is told what is wrong with it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.meter.hioki import IM3523
from rcskin.hardware.meter.meter_reading import MeterReading
from rcskin.hardware.record.measured_sweep import (
    InterfaceTrace,
    MeasuredSweep,
    SweepChecker,
    SweepLimits,
    frozen_remarks,
)
from rcskin.hardware.virtual.hioki import HiokiSettings
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.sweeps import parallel_capacitance
from rcskin.simulator.sweeps.reading_quantities import GAIN, IMPEDANCE

FREQUENCY = np.geomspace(1e3, 1e5, 9)
SETTINGS = {
    "level": "V",
    "voltage": 1.0,
    "constant_voltage": 1.0,
    "constant_current": 1e-3,
    "auto_range": True,
    "speed": "MEDIUM",
    "averaging": 1,
    "cable": 0,
}
JUDGE = SweepChecker(read_table(), SETTINGS, SweepLimits(), IM3523.conditions)
LINE = 1e5 / np.sqrt(1j * FREQUENCY / 1e4) / np.tanh(np.sqrt(1j * FREQUENCY / 1e4))


def trace_of(Z, kind=IMPEDANCE, **shown):
    readings = [
        MeterReading(z, kind=kind, shown={name: float(of[k]) for name, of in shown.items()})
        for k, z in enumerate(Z.tolist())
    ]
    return InterfaceTrace(tuple(FREQUENCY.tolist()), tuple(readings))


def sweep_of(Z):
    return MeasuredSweep((trace_of(Z),))


def test_a_line_breaks_no_law():
    assert JUDGE.remarks(sweep_of(LINE), [], unpressed=False) == []


@given(st.integers(1, 7), st.sampled_from([0.6, 1.5]))
def test_a_reading_far_off_is_noticed(number, factor):
    Z = LINE.copy()
    Z[number] *= factor
    remarks = JUDGE.remarks(sweep_of(Z), [], unpressed=False)
    assert any("is broken at" in remark and "Hz" in remark for remark in remarks)


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=9, max_size=9))
def test_errors_within_the_meters_bounds_are_no_violation(errors):
    Z = LINE.copy()
    for n, (of_size, of_phase) in enumerate(errors):
        dz, dt = JUDGE.table.error_bounds(
            complex(Z[n]), JUDGE._conditions(FREQUENCY[n], complex(Z[n]))
        )
        Z[n] *= (1 + of_size * dz) * np.exp(1j * of_phase * dt)
    assert JUDGE.remarks(sweep_of(Z), [], unpressed=False) == []


def test_a_range_whose_error_is_not_known_is_reported():
    Z = 30 * LINE
    Z[3] *= 0.3
    remarks = JUDGE.remarks(sweep_of(Z), [], unpressed=False)
    assert remarks
    told = "(estimated: 3522-50-derived has no range of 1e+07, 1e+08 ohm)"
    assert all(told in remark for remark in remarks)


def test_a_frequency_that_is_another_shows_in_Cp():
    Cp, digits = parallel_capacitance(LINE, FREQUENCY / 2), parallel_capacitance(LINE, FREQUENCY)
    shown = MeasuredSweep((trace_of(LINE, Cp=1.0004 * digits),))
    assert JUDGE.remarks(shown, [], unpressed=False) == []
    wrong = MeasuredSweep((trace_of(LINE, Cp=Cp),))
    (remark,) = JUDGE.remarks(wrong, [], unpressed=False)
    assert remark.startswith("Cp does not follow from Rs, X and f at 9 frequencies")


def test_each_interface_is_judged_by_its_own_and_named():
    def at_both(left, bottom):
        traces = [sweep_of(Z).traces[0] for Z in (left, bottom)]
        names = zip(traces, ("left", "bottom"), strict=True)
        return MeasuredSweep(
            tuple(dataclasses.replace(each, interface=name) for each, name in names)
        )

    sound, moved = at_both(LINE, 3 * LINE), at_both(LINE, 3.3 * LINE)
    assert JUDGE.remarks(sound, [sound], unpressed=False) == []
    (remark,) = JUDGE.remarks(moved, [sound], unpressed=False)
    assert remark.startswith("interface bottom: differs from earlier repetitions by 10.0 %")


@pytest.mark.parametrize(
    ("unpressed", "expected"),
    [
        (False, "differs from earlier repetitions by 8"),
        (True, "the unpressed skin has drifted by 8"),
    ],
)
def test_departures_are_measured_in_Z(unpressed, expected):
    earlier = [sweep_of(LINE), sweep_of(LINE)]
    assert JUDGE.remarks(sweep_of(1.04 * LINE), earlier, unpressed) == []
    (remark,) = JUDGE.remarks(sweep_of(1.08 * LINE), earlier, unpressed)
    assert remark.startswith(expected)
    assert "% of |Z| at" in remark and "(allowed: 5 %)" in remark


def test_departures_of_gains_are_named_as_gains():
    earlier, later = (MeasuredSweep((trace_of(Z, GAIN),)) for Z in (LINE, 1.08 * LINE))
    (remark,) = JUDGE.remarks(later, [earlier], unpressed=True)
    assert "% of |V / V_s| at" in remark


def test_drift_is_counted_from_the_first_sweep_at_rest():
    creeping = [sweep_of((1 + 0.02 * n) * LINE) for n in range(4)]
    assert JUDGE.remarks(creeping[2], creeping[:2], unpressed=True) == []
    assert JUDGE.remarks(creeping[3], creeping[:3], unpressed=True) != []
    assert JUDGE.remarks(creeping[3], creeping[:3], unpressed=False) == []


def test_speed_and_fixed_range_enter_the_tolerance():
    fast = dataclasses.replace(JUDGE, settings={**SETTINGS, "speed": "FAST"})
    far = dataclasses.replace(JUDGE, settings={**SETTINGS, "auto_range": False, "range": 5})
    line = trace_of(LINE)
    usual = JUDGE.error_bounds(line)
    assert fast.error_bounds(line).size == pytest.approx(2.5 * usual.size)
    assert (far.error_bounds(line).size > usual.size).all()


@pytest.mark.parametrize("zero", [0, 4, 8])
@pytest.mark.parametrize("tripled", [1, 4, 7])
def test_a_reading_without_resistance_hides_no_other_fault(zero, tripled):
    Z = LINE.copy()
    Z[tripled] *= 3
    Z[zero] = 1j * Z[zero].imag
    remarks = JUDGE.remarks(sweep_of(Z), [], unpressed=False)
    assert any("is broken" in remark for remark in remarks)


@pytest.mark.parametrize("level", ["V", "CV", "CC"])
def test_bounds_follow_the_open_voltage_behind_the_output_resistance(level):
    """What holds the level at the skin, recorder and virtual meter tell alike."""
    asked = {"level": level, "voltage": 0.4, "constant_voltage": 0.3, "constant_current": 1e-3}
    Z = -100j
    judge = dataclasses.replace(JUDGE, settings={**SETTINGS, **asked})
    expected = {"V": 0.4, "CV": 0.3 * np.sqrt(2), "CC": 1e-3 * 100 * np.sqrt(2)}[level]
    assert judge._conditions(1e3, Z).level == pytest.approx(expected)
    assert HiokiSettings(**asked).in_range(5, Z).level == pytest.approx(expected)


@pytest.mark.parametrize("two_terminal", [True, False])
def test_the_same_digits_at_all_frequencies_and_a_wrong_range_are_named(two_terminal):
    """Also where no law of passive skins can be checked."""
    judge = dataclasses.replace(JUDGE, limits=SweepLimits(two_terminal=two_terminal))
    stuck, wrong = np.full(9, LINE[4]), LINE.copy()
    wrong[4] *= 10
    remarks = judge.remarks(sweep_of(stuck), [], unpressed=True)
    assert any("digit for digit, at all 9 frequencies: is the device stuck?" in r for r in remarks)
    remarks = judge.remarks(sweep_of(wrong), [], unpressed=False)
    assert any(remark.startswith("the reading at 10000 Hz is about") for remark in remarks)


def test_a_sweep_that_repeats_the_one_before_is_a_fault_where_there_is_noise():
    random = np.random.default_rng(1)
    noisy = [sweep_of(LINE * (1 + 1e-4 * random.normal(size=9))) for _ in range(5)]
    (remark,) = frozen_remarks(noisy[4], noisy[4], noisy[:4])
    assert remark.startswith("the sweep repeats the one before digit for digit")
    assert frozen_remarks(noisy[4], noisy[3], noisy[:4]) == []
    assert frozen_remarks(noisy[0], None, []) == []
    exact = [sweep_of(LINE)] * 4
    assert frozen_remarks(exact[0], exact[0], exact) == []
    assert frozen_remarks(sweep_of(1.1 * LINE), sweep_of(1.1 * LINE), exact) == []
