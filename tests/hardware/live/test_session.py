"""Live localization at a virtual meter, over a real socket: right answers, or none."""

import time

import numpy as np
import pytest
from rcskin.hardware.live.live_baseline import RENEWAL_COUNT
from rcskin.hardware.live.live_session import BASELINE_KEY, END_KEY
from rcskin.hardware.meter.errors import FailedReadingError, MeterError, NoConnectionError
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.tests.hardware.live.live_rig import SKINS, Columns

pytestmark = pytest.mark.usefixtures("impatient")


def test_presses_are_answered_at_their_columns(session, press):
    live = session({1: press("1,2"), 2: press("2,3"), 3: press("none"), 4: press("1,1")})
    live.run(5)
    none = "nothing pressed"
    assert live.display.labels == [none, "column 2", "column 3", none, "column 1"]
    lit = live.display.moments[2].answer.pixels
    assert (lit[:, 2] > 0.99).all() and (lit[:, :2] < 0.01).all()
    assert live.failed == 0


def test_it_asks_to_leave_the_skin_untouched_first(session):
    live = session(rest=3)
    live.run(1)
    leave = [f"leave the skin untouched: unpressed sweep {n} of 3" for n in (1, 2, 3)]
    assert live.display.told == [*leave, "ready: the skin may be touched"]
    assert len(live.baseline.sweeps) == 3


def test_a_model_that_needs_no_rest_is_answered_from_the_first_sweep(session):
    live = session(localizer=Columns(uses_baseline=False))
    live.run(1)
    assert (live.display.told, live.display.labels) == ([], ["nothing pressed"])


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (Fault("drop"), "check"),
        (Fault("drop", times=3), "check"),
        (Fault("late", seconds=0.3), "no whole answer within 0.2 s"),
        (Fault("silent"), "no whole answer within 0.2 s"),
        (Fault("silent", times=4), "no whole answer within 0.2 s"),
        (Fault("garbage"), "no line of text"),
        (Fault("half"), "no whole answer within 0.2 s"),
        (Fault("status"), "status 7: overflow"),
        (Fault("status", times=2, status=9), "status 9: sampling error"),
        (Fault("forget"), "the meter was switched off and on"),
    ],
)
def test_a_fault_costs_its_sweep_and_is_reported(session, press, instrument, fault, told):
    live = session({1: press("1,3"), 2: lambda: instrument.faults.add(fault)})
    live.run(4)
    assert live.display.labels == ["nothing pressed", *["column 3"] * 3]
    assert any(told in why and "trying again" in why for why in live.display.told)
    assert live.display.moments[-1].failed == live.failed >= 1
    frequencies = live.localizer.model.frequencies
    truth = [SKINS["left"].impedance("1,3", f) for f in frequencies]
    for asked in live.localizer.asked[1:]:
        assert impedance(asked)[0, 0] == pytest.approx(np.array(truth), rel=1e-4)


def test_faults_before_the_first_answer_are_survived(session, instrument):
    for kind in ("garbage", "drop", "status", "forget", "silent"):
        instrument.faults.add(Fault(kind))
    live = session()
    live.run(1)
    assert live.display.labels == ["nothing pressed"]


def test_changed_settings_are_reported_and_set_back(session, instrument):
    live = session({1: lambda: setattr(instrument.settings, "cable", 1)})
    live.run(2)
    assert any("`cable` is 1 and was 0" in why for why in live.display.told)
    assert (live.failed, instrument.settings.cable) == (1, 0)


def test_another_meter_is_reported_and_never_answered(session, instrument):
    def exchange():
        instrument.serial = "111111111"
        instrument.faults.add(Fault("drop"))

    live = session({1: exchange}, patience=0.3)
    with pytest.raises(NoConnectionError, match=r"gave no sweep for 0.3 s.*now HIOKI,IM3523,1111"):
        live.run(3)
    assert len(live.display.moments) == 1


def test_a_lost_correction_cannot_be_set_again(session, instrument):
    instrument.settings.open_correction = "ALL"
    live = session({1: lambda: instrument.faults.add(Fault("forget"))}, patience=0.3)
    with pytest.raises(NoConnectionError, match=r"open correction was ALL .* and is OFF now"):
        live.run(3)
    assert len(live.display.moments) == 1


def test_a_meter_that_stays_silent_is_given_up_in_one_line(session, instrument):
    live = session({1: lambda: instrument.faults.add(Fault("drop", times=10**6))}, patience=0.3)
    begun = time.monotonic()
    with pytest.raises(NoConnectionError, match="the meter gave no sweep for 0.3 s") as raised:
        live.run(3)
    assert 0.3 <= time.monotonic() - begun < 3
    assert "\n" not in str(raised.value)


def test_waits_grow_and_begin_anew_after_a_whole_sweep(session, instrument):
    live = session()
    live.meter.ready()
    failure = MeterError("gone")
    waits = [live.meter.wait_after_failure(failure) for _ in range(3)]
    assert waits[1:] == [2 * waits[0], 4 * waits[0]]
    live.run(1)
    assert live.meter.wait_after_failure(failure) == waits[0]


def test_failed_readings_alone_are_no_reason_to_give_up(session, instrument):
    live = session({1: lambda: instrument.faults.add(Fault("status", times=30))}, patience=1e-9)
    live.run(2)
    assert live.failed == 30


def test_a_failed_reading_shows_that_the_meter_is_there(session):
    link = session(patience=0.2).meter
    link.wait_after_failure(MeterError("gone"))
    time.sleep(0.3)
    assert link.wait_after_failure(FailedReadingError("overflow")) == 0
    assert link.wait_after_failure(MeterError("gone")) > 0


def test_a_sweep_that_breaks_a_law_has_no_answer(session, instrument):
    whole = instrument.bench.skin.impedance
    skin = instrument.bench.skin

    def inductive():
        skin.impedance = lambda press, frequency: whole(press, frequency).conjugate()

    def heal(why):
        live.display.told.append(why)
        skin.impedance = whole

    live = session({1: inductive})
    live.display.no_answer = heal
    live.run(2)
    assert "the sweep is unsound: Im Z <= 0 is broken" in live.display.told[-1]
    assert (live.failed, live.display.labels) == (1, ["nothing pressed"] * 2)


def test_keys_take_the_rest_anew_and_end_the_session(session, press):
    """What is pressed while the rest is taken belongs to it."""
    typed = iter(["", "", "", "", BASELINE_KEY, "", "", "", END_KEY])
    live = session({1: press("1,1")}, rest=2, key=lambda: next(typed))
    live.run()
    assert live.display.labels == ["nothing pressed", "column 1", *["nothing pressed"] * 2]
    assert sum("sweep 1 of 2" in why for why in live.display.told) == 2


def test_times_are_what_they_are_called(session, instrument):
    instrument.pace = 1.0
    live = session(localizer=Columns(uses_baseline=False))
    begun = time.perf_counter()
    live.run(4)
    whole = time.perf_counter() - begun
    moments = live.display.moments
    assert sum(moment.latency for moment in moments) < whole
    assert all(moment.measuring > 3 * 5e-3 for moment in moments)
    assert moments[0].since_before is None and moments[0].rate is None
    assert all(moment.latency < moment.since_before < whole for moment in moments[1:])
    assert 1 / moments[-1].rate < whole


class Asking(Columns):
    """Asks for its highest frequency, then for its lowest, and answers by these."""

    def adaptive_sweep(self, rest, gap, /):
        return Two(self, rest)


class Two:
    def __init__(self, localizer, rest):
        self.localizer, self.rest, self.told = localizer, rest, {}
        self.wanted = list(localizer.model.frequencies)

    def next(self, seconds, /):
        assert seconds.shape == (1, 3) and (seconds > 0).all()
        if len(self.told) == 2:
            return None
        return "left", self.wanted.pop(-1 if len(self.wanted) == 3 else 0)

    def add_reading(self, interface, frequency, Z, /):
        self.told[frequency] = Z

    def answer(self, during, /):
        part = self.rest.sel(frequency=sorted(self.told))[{"sweep": [0]}].copy(deep=True)
        part["X"].values[0, 0] = [self.told[f].imag for f in sorted(self.told)]
        part["Rs"].values[0, 0] = [self.told[f].real for f in sorted(self.told)]
        return Columns.answer(self.localizer, part, self.rest, 0.0, during)


def test_single_frequencies_are_measured_in_any_order_and_answered(session, press):
    """Once in RENEWED_AFTER answers at rest a whole sweep is measured, which follows drift."""
    asked = []
    live = session({RENEWAL_COUNT + 1: press("1,3")}, localizer=Asking(), rest=2)
    live.display.reading = lambda frequency, reading: asked.append(frequency)
    live._reading_times.on_reading = live.display.reading
    live.run(RENEWAL_COUNT + 3)
    whole, part = list(live.localizer.model.frequencies), [16e3, 1e3]
    renewing = part * (RENEWAL_COUNT - 2) + whole + part
    assert asked == [*whole, *whole, *renewing, *part * 3]
    assert live.display.labels == [*["nothing pressed"] * (RENEWAL_COUNT + 1), *["column 3"] * 2]
    assert any("follow slow drift" in note for note in live.display.notes)


def test_a_fault_in_part_of_a_sweep_costs_that_part(session, press, instrument):
    live = session({1: lambda: instrument.faults.add(Fault("status"))}, localizer=Asking())
    live.run(3)
    assert (live.failed, live.display.labels) == (1, ["nothing pressed"] * 3)


def test_the_meter_is_left_as_it_was_found(session, instrument):
    instrument.settings.frequency = 2e3
    live = session()
    live.run(1)
    assert (instrument.settings.trigger, instrument.settings.frequency) == ("EXTERNAL", 16e3)
    live.meter.station.release()
    assert (instrument.settings.trigger, instrument.settings.frequency) == ("INTERNAL", 2e3)


def test_frequencies_that_the_meter_has_not_are_bad_input(session):
    live = session(localizer=Columns(frequencies=(1e3, 1e6)))
    with pytest.raises(InputError, match="meter IM3523 reads 40 Hz to 200 kHz"):
        live.run(1)


class Stuck:
    """A readout with noise, whose converter repeats its last readings once it is stuck."""

    def __init__(self):
        self.random, self.latest, self.stuck = np.random.default_rng(0), {}, False

    def __call__(self, Z, conditions):
        if not self.stuck:
            self.latest[conditions.frequency] = Z * (1 + 1e-4 * self.random.normal())
        return self.latest[conditions.frequency]


@pytest.fixture
def readout():
    return Stuck()


class TestStuck:
    """The meter has noise, until it repeats itself."""

    @pytest.fixture
    def instrument(self, make_instrument, cushion, readout):
        return make_instrument(cushion, readout)

    def test_a_meter_that_repeats_its_sweep_is_not_answered(self, session, readout):
        live = session({2: lambda: setattr(readout, "stuck", True)}, rest=5)
        live.display.no_answer = lambda why: (
            live.display.told.append(why)
            or (setattr(readout, "stuck", False) if "device stuck" in why else None)
        )
        live.run(4)
        assert live.failed == 1 and any("is the device stuck?" in w for w in live.display.told)
