"""How the virtual meter writes numbers, and what a reading holds."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.virtual.hioki import OVER, measured_text
from rcskin.hardware.virtual.language import engineering
from rcskin.hardware.virtual.measurement import quantity
from rcskin.simulator.sweeps.reading_quantities import parallel_capacitance, series_capacitance

SIX_DIGITS = re.compile(r"[ -]\d{1,3}\.\d{3,5}E[+-]\d{2}")
magnitudes = st.floats(1e-18, 1e18)


@given(magnitudes, st.booleans())
def test_six_digits_and_an_exponent_in_threes(value, negative):
    text = measured_text(-value if negative else value)
    assert SIX_DIGITS.fullmatch(text)
    assert sum(letter.isdigit() for letter in text.split("E")[0]) == 6
    assert int(text.split("E")[1]) % 3 == 0
    assert float(text) == pytest.approx(-value if negative else value, rel=5.01e-6)


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (4992.99, 6, "4.99299E+03"),
        (49929.9, 6, "49.9299E+03"),
        (999999.9, 6, "1.00000E+06"),
        (1000, 5, "1.0000E+03"),
        (0, 6, "0.00000E+00"),
        (40, 5, "40.000E+00"),
    ],
)
def test_as_the_meter_writes_them(value, digits, text):
    assert engineering(value, digits) == text


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan, 1e31])
def test_what_no_display_holds_is_overflow(value):
    assert measured_text(value) == OVER == " 999999E+28"


@given(st.floats(1, 1e6), st.floats(-1e6, -1), st.floats(40, 2e5))
def test_quantities_follow_from_impedance(Rs, X, frequency):
    Z = complex(Rs, X)
    shown = {name: quantity(name, Z, frequency) for name in ("CP", "CS", "D", "Q", "RP", "G", "B")}
    assert shown["CP"] == pytest.approx(parallel_capacitance(Z, frequency), rel=1e-9)
    assert shown["CS"] == pytest.approx(series_capacitance(Z, frequency), rel=1e-9)
    assert shown["D"] * shown["Q"] == pytest.approx(1)
    assert shown["RP"] * shown["G"] == pytest.approx(1)
    assert complex(shown["G"], shown["B"]) * Z == pytest.approx(1)


def test_a_reading_holds_what_was_asked_in_the_order_of_the_registers(say):
    line = ":TRIG EXT;:MEAS:ITEM 16,18;VALid 18"
    reading = say(line, "*TRG;:MEAS?")[1]
    status, Cp, Rs, X = reading.split(",")
    assert (status, Rs) == ("0", " 10.0000E+03")
    assert float(X) == pytest.approx(-159155, rel=1e-5)
    assert float(Cp) == pytest.approx(996.068e-12, rel=1e-5)
    assert all(SIX_DIGITS.fullmatch(value) for value in (Cp, Rs, X))


def test_the_displayed_pair_where_no_item_is_asked(say):
    setting = ":PAR1 Z;PAR2 PHASE;:TRIG EXT;:MEAS:VALid 31"
    assert say(setting, "*TRG;:MEAS?")[1] == "0, 159.469E+03, -86.405,0"


@pytest.mark.parametrize(("valid", "parts"), [(16, 1), (2, 2), (18, 3), (1, 1), (19, 4), (8, 1)])
def test_valid_says_what_a_reading_holds(say, valid, parts):
    reading = say(f":TRIG EXT;:MEAS:VALid {valid}", "*TRG;:MEAS?")[1]
    assert len(reading.split(",")) == parts
