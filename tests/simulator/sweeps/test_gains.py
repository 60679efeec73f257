"""Sweeps of gains: their variables, and the files that hold them."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, build, concatenate, impedance, read, write
from rcskin.simulator.sweeps.joining import join
from rcskin.simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE
from rcskin.simulator.sweeps.reading_subset import restricted
from rcskin.simulator.sweeps.schema import complex_readings

G = np.array([[[0.9 - 0.1j, 0.5 - 0.4j]], [[0.8 - 0.2j, 0.3 - 0.3j]]])
ROW = "0,none,0,0,left,1000"


def gains(kind=GAIN, **more):
    return build(
        G,
        [1e3, 2e3],
        interface=["left"],
        press=["none", "1,1:2.0"],
        row=[0, 1],
        column=[0, 1],
        kind=kind,
        **more,
    ).dataset()


def test_gains_have_variables_of_their_own():
    sweeps = gains(errors={"gain_error": np.full(G.shape, 1e-6)})
    np.testing.assert_allclose(sweeps["gain"], np.abs(G))
    np.testing.assert_allclose(sweeps["gain_phase"], np.angle(G))
    assert sweeps["gain"].attrs["units"] == "1"
    assert sweeps["gain_phase"].attrs["units"] == "rad"
    assert sweeps["gain_error"].attrs["units"] == "1"
    assert not {"Rs", "X", "Cp"} & set(sweeps.variables)
    np.testing.assert_allclose(complex_readings(sweeps), G)


@pytest.mark.parametrize("kind", [IMPEDANCE, GAIN, MAGNITUDE], ids=lambda kind: kind.name)
def test_quantities_and_the_reading_follow_from_each_other(kind):
    readings, frequency = np.abs(G) + 0j if kind is MAGNITUDE else G, np.array([1e3, 2e3])
    values = kind.values(readings, frequency)
    assert tuple(values) == kind.names
    np.testing.assert_allclose(kind.reading(values), readings, rtol=1e-15)


def test_what_a_meter_shows_is_not_computed():
    Cp, frequency = np.full(G.shape, 7e-11), np.array([1e3, 2e3])
    shown = IMPEDANCE.values(G, frequency, {"Cp": Cp})
    assert shown["Cp"] is Cp
    np.testing.assert_array_equal(shown["X"], G.imag)


def test_magnitudes_have_no_phase():
    sweeps = gains(MAGNITUDE)
    assert "gain_phase" not in sweeps
    np.testing.assert_allclose(complex_readings(sweeps), np.abs(G))


@pytest.mark.usefixtures("replacing")
@pytest.mark.parametrize("kind", [GAIN, MAGNITUDE])
@pytest.mark.parametrize("ending", [".nc", ".csv", ".zarr"])
def test_gains_are_read_back_to_the_same_bits(tmp_path, kind, ending):
    taken = np.array([[True, False]])
    for sweeps in (gains(kind), restricted(gains(kind), taken)):
        write(sweeps, tmp_path / f"all{ending}")
        again = read(tmp_path / f"all{ending}")
        assert set(again.data_vars) == set(kind.names)
        for name in kind.names:
            np.testing.assert_array_equal(again[name].values, sweeps[name].values)


def test_the_columns_of_a_csv_name_the_quantities(tmp_path):
    write(gains(), tmp_path / "gains.csv")
    header = next(
        line
        for line in (tmp_path / "gains.csv").read_text().splitlines()
        if not line.startswith("#")
    )
    assert header.endswith("interface,frequency_Hz,gain,gain_phase_rad")
    write(gains(MAGNITUDE), tmp_path / "magnitudes.csv")
    assert "frequency_Hz,gain\n" in (tmp_path / "magnitudes.csv").read_text()


def test_gains_are_joined_with_gains(tmp_path):
    assert concatenate([gains(), gains()]).sizes["sweep"] == 4
    assert set(join([gains(), gains()], ["a", "b"]).data_vars) == {"gain", "gain_phase"}


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (GAIN, MAGNITUDE, "b: every reading is the magnitude of the gain, those of a are the gain"),
        (MAGNITUDE, GAIN, "b: every reading is the gain, those of a are the magnitude of the gain"),
    ],
)
def test_two_kinds_of_readings_are_not_joined(first, second, message):
    with pytest.raises(InputError, match=message):
        join([gains(first), gains(second)], ["a", "b"])
    with pytest.raises(InputError, match="cannot be joined"):
        concatenate([gains(first), gains(second)])


def test_an_impedance_is_not_made_of_gains():
    with pytest.raises(InputError, match="the readings are the gain; the impedance is needed here"):
        impedance(gains())


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        ("gain,Rs_ohm", "0.5,100", "columns `gain` and `Rs_ohm` are of two kinds of readings"),
        ("gain_phase_rad", "0.5", "column `gain` is missing"),
        ("gain,gain_phase_rad", "0.5,", "line 2: `gain_phase_rad` must be a finite number, got ''"),
    ],
)
def test_a_csv_that_holds_no_gains_is_refused(tmp_path, header, row, message):
    path = tmp_path / "wrong.csv"
    path.write_text(f"sweep,press,row,column,interface,frequency_Hz,{header}\n{ROW},{row}\n")
    with pytest.raises(InputError, match=message):
        read(path)
