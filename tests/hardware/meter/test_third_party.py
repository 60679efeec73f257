"""Clients that know nothing of this project: PyVISA's own calls, and an instrument of pymeasure."""

import pytest
import pyvisa
from pymeasure.instruments import Instrument
from pymeasure.instruments.agilent import Agilent4284A, AgilentE4980
from pymeasure.instruments.validators import strict_range
from rcskin.hardware.virtual.keysight_lcr import Virtual4284A, VirtualE4980A


@pytest.fixture
def bare(ports):
    """The virtual meter as PyVISA opens it, with terminations and nothing else."""
    manager = pyvisa.ResourceManager("@py")
    resource = manager.open_resource(
        ports.resource, read_termination="\r\n", write_termination="\r\n", timeout=1000
    )
    yield resource
    resource.close()


def test_queries_of_plain_pyvisa(bare):
    assert bare.query("*IDN?") == "HIOKI,IM3523,000000000,V1.00"
    bare.write(":TRIGger EXTernal;:MEASure:ITEM 16,18;VALid 18;:FREQ 10E3")
    assert bare.query(":FREQuency?") == "10.000E+03"
    status, Cp, Rs, X = bare.query_ascii_values("*TRG;:MEASure?")
    assert (status, Rs) == (0, 10e3)
    assert Cp * X < 0


def test_a_wrong_query_times_out_and_the_register_says_why(bare):
    bare.timeout = 100
    bare.query("*ESR?")
    with pytest.raises(pyvisa.VisaIOError):
        bare.query(":FREQu?")
    assert bare.query("*ESR?") == "32"


class Lcr(Instrument):
    """A meter as a user of pymeasure would write it."""

    frequency = Instrument.control(
        ":FREQ?", ":FREQ %g", "Frequency, Hz", validator=strict_range, values=[40, 200e3]
    )
    level = Instrument.control(":LEV:VOLT?", ":LEV:VOLT %g", "Open voltage, V")
    reading = Instrument.measurement("*TRG;:MEAS?", "Status and values")


def test_an_instrument_of_pymeasure(ports):
    lcr = Lcr(
        ports.resource,
        "LCR meter",
        includeSCPI=False,
        visa_library="@py",
        read_termination="\r\n",
        write_termination="\r\n",
        timeout=1000,
    )
    try:
        assert "IM3523" in lcr.ask("*IDN?")
        lcr.write(":TRIG EXT;:MEAS:ITEM 0,2;VALid 18")
        lcr.frequency, lcr.level = 5e3, 0.5
        assert (lcr.frequency, lcr.level) == (5e3, 0.5)
        assert lcr.reading == [0, 10e3]
    finally:
        lcr.adapter.close()


FREQUENCIES = [1e3 * n for n in range(1, 13)]


SETTINGS_OF_PYMEASURE = {
    lambda lcr: lcr: (
        "frequency",
        "ac_current",
        "bias_enabled",
        "bias_voltage",
        "bias_current",
        "impedance_mode",
        "impedance_range",
        "auto_range_enabled",
        "trigger_source",
        "trigger_delay",
        "trigger_continuous_enabled",
        "high_power_enabled",
        "options",
    ),
    lambda lcr: lcr.correction: (
        "open_enabled",
        "short_enabled",
        "load_enabled",
        "load_function",
        "cable_length",
    ),
    lambda lcr: lcr.correction.spot1: ("enabled", "frequency", "load_function"),
}


def reactances(pillow):
    return pytest.approx([pillow.impedance("none", f).imag for f in FREQUENCIES], rel=1e-5)


def test_the_driver_of_pymeasure_for_the_4284a(make_instrument, serve, pillow):
    """It sweeps twelve frequencies in lists of ten, and polls the operation register."""
    with serve(make_instrument(kind=Virtual4284A)) as ports:
        lcr = Agilent4284A(ports.resource, visa_library="@py")
        try:
            lcr.reset()
            lcr.frequency, lcr.ac_voltage, lcr.impedance_mode = 5e3, 0.5, "RX"
            assert (lcr.frequency, lcr.ac_voltage, lcr.impedance_mode) == (5e3, 0.5, "RX")
            R, X, swept = lcr.sweep_measurement("frequency", FREQUENCIES)
            assert (R, X, swept) == ([10e3] * 12, reactances(pillow), FREQUENCIES)
            lcr.correction.load_function = lcr.impedance_mode = "CPRP"
            lcr.correction.cable_length, lcr.correction.load_enabled = 2, True
            lcr.correction.spot1.frequency, lcr.correction.spot1.enabled = 2e4, True
            lcr.bias_voltage, lcr.bias_enabled, lcr.ac_current = 1.5, True, 1e-3
            lcr.impedance_range, lcr.trigger_delay, lcr.trigger_source = 1e3, 0.5, "BUS"
            lcr.trigger_continuous_enabled = False
            lcr.trigger_initiate()
            assert lcr.trigger()[2] == 0
            for owner, names in SETTINGS_OF_PYMEASURE.items():
                for name in names:
                    assert getattr(owner(lcr), name) is not None
            assert (lcr.correction.load_function, lcr.bias_voltage) == ("CPRP", 1.5)
            assert lcr.sweep_measurement("bias_voltage", [0.5, 1.0])[2] == [0.5, 1.0]
            assert lcr.check_errors() == []
        finally:
            lcr.adapter.close()


@pytest.mark.filterwarnings("ignore:It is not known whether this device:FutureWarning")
def test_the_driver_of_pymeasure_for_the_e4980a(make_instrument, serve, pillow):
    ends = {"read_termination": "\n", "write_termination": "\n"}
    with serve(make_instrument(kind=VirtualE4980A)) as ports:
        lcr = AgilentE4980(ports.resource, visa_library="@py", **ends)
        try:
            lcr.mode, lcr.frequency, lcr.ac_voltage = "RX", 5e3, 0.5
            lcr.aperture("SHORT", 4)
            assert (lcr.mode, lcr.frequency, lcr.aperture()) == ("RX", 5e3, ("SHOR", 4))
            assert lcr.impedance == [10e3, pytest.approx(-31831.0)]
            R, X, swept = lcr.freq_sweep(FREQUENCIES, return_freq=True)
            assert (R, X, swept) == ([10e3] * 12, reactances(pillow), FREQUENCIES)
            assert lcr.check_errors() == []
        finally:
            lcr.adapter.close()
