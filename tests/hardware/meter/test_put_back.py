"""A meter is left as it was found, whatever was set and however the work with it ended."""

import time

import pytest
from rcskin.hardware.meter.hioki import HiokiMeter
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.managed_meter import ManagedMeter
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.tests.hardware.instrument_cases import CASES, E4980A, HP4284A, IM3523

NOT_AS_FOUND = "the meter did not confirm these original settings; check them on the meter:"
HIOKI_ONLY = pytest.mark.parametrize("case", [IM3523], indirect=True, ids=["IM3523"])


@pytest.fixture(params=CASES, ids=lambda case: case.model)
def case(request):
    """An instrument: how it is found, and what is set."""
    return request.param


@pytest.fixture
def as_found(case):
    """Settings that no command here leaves untouched."""
    return case.found()


@pytest.fixture
def instrument(make_instrument, case):
    """The virtual instrument, as found."""
    return make_instrument(kind=VIRTUAL_MODELS[case.model], settings=case.found())


@HIOKI_ONLY
@pytest.mark.parametrize("automatic", [True, False])
def test_a_range_that_was_set_or_searched_for_is_put_back(ports, instrument, automatic):
    instrument.settings.auto_range = automatic
    with open_meter(ports.resource, 1) as meter:
        meter.range = 9
        meter.auto_range = not automatic
        meter.read()
    assert (instrument.settings.range, instrument.settings.auto_range) == (7, automatic)


@pytest.mark.parametrize("case", [E4980A, HP4284A], indirect=True, ids=lambda case: case.model)
def test_a_level_of_the_other_kind_is_put_back(ports, instrument, case, as_found):
    with open_meter(ports.resource, 0.3) as meter:
        for amplitude in ("0.25 V", "0.004 A"):
            meter.amplitude = amplitude
            assert meter.amplitude == amplitude
    now, found = instrument.settings, as_found
    assert (now.level, getattr(now, now.level)) == (found.level, getattr(found, found.level))


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
@pytest.mark.parametrize(("kind", "values"), [("frequency", ()), ("voltage", (0.5, 1.0))])
def test_a_list_that_is_empty_or_of_no_frequencies_is_emptied(ports, instrument, kind, values):
    instrument.settings.list_kind, instrument.settings.list_values = kind, values
    with open_meter(ports.resource, 0.2) as meter:
        assert len(meter.read_sweep([1e3, 2e3])) == 2
    assert instrument.settings.list_values == ()


@HIOKI_ONLY
def test_only_what_was_set_is_touched(ports, instrument):
    with open_meter(ports.resource, 1) as meter:
        meter.read()
        instrument.settings.cable, instrument.settings.voltage = 0, 3.0
    assert (instrument.settings.cable, instrument.settings.voltage) == (0, 3.0)


@HIOKI_ONLY
def test_a_meter_that_stays_away_is_reported(ports, instrument):
    told = []
    station = ManagedMeter(lambda: open_meter(ports.resource, 0.2), report=told.append)
    station.ready()
    instrument.faults.add(Fault("drop", times=10**6))
    station.release()
    assert told == [
        "the meter did not confirm these original settings; check them on the meter: "
        "header = True, mode = CONTINUOUS, trigger = INTERNAL, items = 1 2, valid = 2"
    ]


@HIOKI_ONLY
def test_a_slow_line_is_given_time_for_each_answer(ports, instrument, as_found, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.record.managed_meter.GIVE_UP_AFTER", 0.3)
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("late", times=10**6, seconds=0.06))
    begun = time.monotonic()
    station.release()
    assert time.monotonic() - begun > 3 * 0.3
    assert instrument.settings == as_found


@HIOKI_ONLY
def test_a_setting_that_the_meter_refuses_is_named_and_all_others_are_put_back(
    ports, instrument, as_found, monkeypatch
):
    told = []
    station = ManagedMeter(lambda: open_meter(ports.resource, 1), report=told.append)
    station.ready().cable = 0
    monkeypatch.setattr(HiokiMeter.cable, "command_text", ":CORRection:CABLe 1,")
    station.release()
    assert told == [f"{NOT_AS_FOUND} cable = 1"]
    as_found.cable = 0
    assert instrument.settings == as_found
