"""The skin at rest in live localization: taken first, asked for anew, and followed as it drifts."""

import pytest
from rcskin.hardware.live.live_baseline import RENEWAL_COUNT
from rcskin.hardware.live.live_session import END_KEY
from rcskin.hardware.meter.errors import MeterError
from rcskin.tests.hardware.pillow import Pillow

pytestmark = pytest.mark.usefixtures("impatient")


def test_a_skin_that_is_touched_while_at_rest_is_asked_for_anew(session, press, instrument):
    live = session(rest=2, drift=0.005)
    told = live.display.no_answer

    def no_answer(why):
        told(why)
        press("1,3" if "sweep 2 of 2" in why and not live.display.notes else "none")()

    live.display.no_answer = no_answer
    live.run(1)
    assert any(
        "may have been touched: the unpressed skin has drifted by 2." in n
        for n in live.display.notes
    )
    assert live.display.labels == ["nothing pressed"]


def test_a_skin_that_never_comes_to_rest_is_an_error(session):
    typed = iter([""] * 20)
    live = session(rest=2, drift=-1.0, key=lambda: next(typed, END_KEY))
    with pytest.raises(MeterError, match="is not stable in 5 trials"):
        live.run(1)


class Drifting(Pillow):
    """A cushion whose capacitance grows with each reading."""

    def __init__(self, each):
        self.each, self.readings = each, 0

    def impedance(self, press, frequency):
        """Z in ohm, at a capacitance that has grown."""
        self.readings += 1
        grown = 1 + self.each * self.readings
        Z = super().impedance(press, frequency)
        return Z.real + 1j * Z.imag / grown


def test_slow_drift_is_followed_where_nothing_is_pressed(
    session, make_instrument, serve, instrument
):
    """By the last answer the skin has drifted further than a press of column 2 changes it."""
    object.__setattr__(instrument.bench, "skin", Drifting(1e-4))
    live = session({70: lambda: None}, rest=2)
    live.run(70)
    assert set(live.display.labels) == {"nothing pressed"}
    assert any("follow slow drift" in note for note in live.display.notes)


def test_drift_since_the_beginning_is_reported(session, instrument):
    object.__setattr__(instrument.bench, "skin", Drifting(1e-4))
    live = session(rest=2, drift=0.01)
    live.run(50)
    assert live.display.moments[0].remarks == ()
    assert "the unpressed skin has drifted by" in live.display.moments[-1].remarks[-1]


def test_rest_is_not_renewed_under_a_press(session, press):
    live = session({1: press("1,1")}, rest=2)
    live.run(2 + RENEWAL_COUNT)
    assert live.display.notes == []
    assert live.display.labels[-1] == "column 1"
