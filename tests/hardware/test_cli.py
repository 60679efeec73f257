"""The meter's commands as their user meets them."""

import json
import re
import socket
import subprocess
import sys

import pytest
from rcskin.hardware.meter.errors import MeterError, NoConnectionError
from rcskin.hardware.meter.instruments import ProbeResult
from rcskin.hardware.virtual.hioki import HiokiSettings
from rcskin.hardware.virtual.recorded_skin import RecordedSkin
from rcskin.hardware.virtual.served_skin import instrument, recorded
from rcskin.simulator.sweeps import InputError, impedance, read
from rich.console import Console


@pytest.fixture
def told(command):
    """What a command prints that ends well."""

    def told(*arguments, **more):
        result = command(*arguments, **more)
        if result.exception:
            raise result.exception
        return result.output

    return told


@pytest.fixture
def recording(told, ports, tmp_path):
    """A file with a recording of the pillow."""
    path = tmp_path / "run.nc"
    control = f"127.0.0.1:{ports.control}"
    where = ["--resource", ports.resource, "--control", control, "-o", path]
    told("record", "pillow", "--repetitions", 2, *where)
    return path


def test_help_loads_nothing_heavy():
    heavy = "{'numpy', 'pyvisa', 'xarray', 'pydantic', 'rich.live'}"
    loaded = f"import sys, rcskin.hardware.cli; sys.exit(bool({heavy} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", loaded], check=False).returncode == 0


def test_identify_names_what_answers(told, ports):
    assert "IM3523 (HIOKI,IM3523," in told("identify", ports.resource)


def test_identify_fails_where_nothing_answers(command):
    result = command("identify", "TCPIP0::127.0.0.1::1::SOCKET", "--timeout", 0.2)
    assert result.exit_code == 1
    assert "check the cable" in result.output


def test_only_a_search_without_names_asks_the_networks_of_the_computer(command, monkeypatch):
    sent = []

    def sendto(_, *given):
        sent.append(given[-1])
        raise OSError("not sent")

    monkeypatch.setattr(socket.socket, "sendto", sendto)
    monkeypatch.setattr(socket.socket, "connect", None)
    monkeypatch.setattr("rcskin.hardware.meter.instruments.probe", lambda *_: ProbeResult(None))
    command("identify")
    assert sent and {port for _, port in sent} == {111}  # the port mapper's, of VXI-11
    sent.clear()
    command("identify", "TCPIP0::127.0.0.1::1::SOCKET")
    assert not sent


def test_press_and_misbehave_go_through_the_side_door(told, command, ports, instrument):
    control = f"127.0.0.1:{ports.control}"
    assert told("press", "2,1", "--control", control) == "2,1\n"
    assert instrument.press == "2,1"
    told("misbehave", "late", "--times", 3, "--seconds", 0.1, "--control", control)
    assert [fault.kind for fault in instrument.faults.waiting] == ["late"]
    assert isinstance(command("press", "x", "--control", control).exception, InputError)


def test_correct_acquires_and_reports_the_state(told, ports):
    answer = told("correct", "open", "--resource", ports.resource)
    assert answer == "open correction ALL, short correction OFF\n"


def test_a_recording_is_written_as_sweeps(recording):
    sweeps = read(recording)
    assert sweeps.sizes == {"sweep": 13, "interface": 1, "frequency": 3}
    assert sweeps.attrs["accuracy"] == "3522-50-derived"


def test_what_the_virtual_meter_records_is_not_called_measured(recording, instrument):
    assert instrument.serial in read(recording).attrs["meter"]
    assert read(recording).attrs["model"] == "virtual meter"


def test_what_a_meter_records_is_called_measured(told, ports, tmp_path, instrument, order):
    instrument.serial = "123456789"
    where = ["--resource", ports.resource, "--order", order("none"), "-o", tmp_path / "a.nc"]
    told("record", "pillow", "--unattended", *where)
    assert read(tmp_path / "a.nc").attrs["model"] == "measured"


def test_settings_of_the_command_line_reach_the_meter(told, ports, tmp_path, instrument):
    order = tmp_path / "order.txt"
    order.write_text("none\n")
    settings = ["--level", "cv", "--amplitude", 0.5, "--speed", "slow", "--range", 8]
    settings += ["--averaging", 2, "--delay", 0.1, "--cable", 1]
    where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "a.csv"]
    told("record", "pillow", "--unattended", *where, *settings)
    kept = json.loads(read(tmp_path / "a.csv").attrs["settings"])
    asked = {"level": "CV", "constant_voltage": 0.5, "range": 8, "auto_range": False, "cable": 1}
    asked |= {"speed": "SLOW", "averaging": 2, "trigger_delay": 0.1}
    assert {name: kept[name] for name in asked} == asked
    assert instrument.settings == HiokiSettings()


@pytest.fixture
def order(tmp_path):
    """A function that writes an order of presses."""

    def order(*presses):
        path = tmp_path / "order.txt"
        path.write_text("\n".join(presses))
        return path

    return order


@pytest.fixture
def by_hand(command, ports, tmp_path, instrument, monkeypatch):
    """A function that records by hand: holds the skin so, types that, and so on; the result."""

    def by_hand(order, *moves, more=()):
        left = list(moves)

        def typed(console, prompt, **_):
            console.print(prompt, markup=False, soft_wrap=True)
            instrument.press, keys = left.pop(0) if left else (instrument.press, None)
            return "" if keys is None else keys + "\n"

        monkeypatch.setattr(Console, "input", typed)
        where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "a.nc", *more]
        return command("record", "pillow", *where)

    return by_hand


def test_a_person_is_led_through_the_presses(by_hand, order, tmp_path):
    result = by_hand(order("none", "2,1", "1,1+2,2"), ("none", ""), ("2,1", ""), ("2,2", ""))
    assert "1/3  Release the skin, then Enter" in result.output
    assert "left  Press row 2, column 1 and hold it, then Enter" in result.output
    assert "left  Press 1,1+2,2 and hold it, then Enter" in result.output
    assert "press 2,1: done; against the unpressed skin Rs" in result.output
    last = f"3 sweeps x 3 frequencies -> {tmp_path / 'a.nc'}; 0 with remarks"
    assert result.output.splitlines()[-1] == last
    assert read(tmp_path / "a.nc").sizes["sweep"] == 3


def test_an_untouched_skin_is_not_taken_for_a_press(by_hand, order, tmp_path):
    untouched, pressed = ("none", ""), ("2,1", "")
    result = by_hand(order("none", "2,1"), untouched, untouched, untouched, pressed)
    assert (
        result.output.count("no press detected: the readings differ from the unpressed skin") == 1
    )
    assert result.output.count("Enter: redo, a: accept anyway, q: quit") == 1
    sweeps = read(tmp_path / "a.nc")
    assert sweeps["Cp"][1, 0, 0] / sweeps["Cp"][0, 0, 0] == pytest.approx(1.02, abs=1e-3)
    assert "0 with remarks" in result.output


def test_an_untouched_skin_is_accepted_where_the_person_wants_it(by_hand, order, tmp_path):
    result = by_hand(order("none", "2,1"), ("none", ""), ("none", ""), ("none", "x"), ("none", "a"))
    assert result.output.count("Enter: redo, a: accept anyway, q: quit") == 2
    assert "1 with remarks" in result.output
    assert "no press detected" in read(tmp_path / "a.nc").attrs["remarks"]


def test_what_the_meter_flagged_is_counted_at_the_end(by_hand, order, instrument):
    result = by_hand(order("none"), ("none", ""), more=["--range", 10])
    told = "0 with remarks; flagged by the meter: 3 readings: outside guaranteed accuracy"
    assert result.output.rstrip().endswith(told)


def test_a_person_decides_whether_a_bad_sweep_is_repeated(by_hand, order):
    moves = [("none", ""), *(("2,1", keys) for keys in ("", "r", "", "a"))]
    result = by_hand(order("none", "none"), *moves, more=["--drift", 1e-3])
    assert result.output.count("the unpressed skin has drifted") == 2
    assert result.output.count("Enter: redo, a: accept anyway, q: quit") == 2
    assert "2 sweeps x 3 frequencies" in result.output and "1 with remarks" in result.output


def test_a_person_has_the_sweep_before_done_again(by_hand, order, tmp_path):
    moves = [("none", ""), ("1,1", ""), ("1,1", "r"), ("2,2", ""), ("2,1", "")]
    result = by_hand(order("none", "2,2", "2,1"), *moves)
    assert result.exit_code == 0
    sweeps = read(tmp_path / "a.nc")
    rise = (sweeps["Cp"] / sweeps["Cp"][0])[:, 0, 0].values
    assert rise == pytest.approx([1, 1.02, 1.02], abs=1e-3)


@pytest.mark.parametrize("last", [[("none", "q")], []])
def test_a_recording_that_was_quit_goes_on_later(by_hand, order, tmp_path, last):
    presses = order("none", "2,1", "none")
    result = by_hand(presses, ("none", ""), ("2,1", ""), *last)
    assert result.exit_code != 0 and not (tmp_path / "a.nc").exists()
    folder = tmp_path / "a.nc.sweeps"
    told = f"2 of 3 sweeps are kept in {folder}; the same command continues after them"
    assert result.output.splitlines()[-1].endswith(told)
    again = by_hand(presses, ("none", ""))
    assert "3/3  Release the skin" in again.output and again.exit_code == 0
    assert read(tmp_path / "a.nc").sizes["sweep"] == 3


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["-o", "a.xlsx"], "must end in .nc or .csv"),
        (["-o", "absent/a.nc"], "the folder absent does not exist"),
        (["-o", "a.nc", "--unattended"], "needs --control or --press-with"),
        (["-o", "a.nc", "--control", "a:1", "--press-with", "b"], "cannot both press"),
        (["-o", "a.nc", "--level", "W"], "`level` must be one of V, CV, CC, got W"),
        (["-o", "a.nc", "--interface", "up"], "`interface` must be one of left, got 'up'"),
        (["-o", "a.nc", "--accuracy", "absent.toml"], "absent.toml: no such file"),
        (["-o", "a.nc", "--unattended", "--press-with", "true", "--speed", "X"], "`speed` must"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    command, ports, tmp_path, monkeypatch, arguments, told
):
    monkeypatch.chdir(tmp_path)
    result = command("record", "pillow", "--resource", ports.resource, *arguments)
    assert isinstance(result.exception, InputError)
    assert told in str(result.exception)
    assert "\n" not in str(result.exception)
    assert list(tmp_path.iterdir()) == []


def test_an_absent_meter_is_a_meter_error_in_one_line(command, tmp_path):
    arguments = ["record", "pillow", "--resource", "TCPIP0::127.0.0.1::1::SOCKET", "--timeout", 0.2]
    result = command(*arguments, "-o", tmp_path / "a.nc", input="\n")
    assert isinstance(result.exception, NoConnectionError | MeterError)
    assert "\n" not in str(result.exception)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([], "either --scene or --recorded"),
        (["--scene", "pillow", "--recorded", "a.nc"], "either --scene or --recorded"),
        (["--recorded", "absent.nc"], "absent.nc: no such file"),
        (["--scene", "pillow", "--pace", "-1"], "`pace` must be in [0, 100], got -1"),
        (["--scene", "pillow", "--model", "LCX"], "`model` must be one of IM3523, E4980A,"),
        (["--scene", "pillow", "--random", "0"], "`random` must be in (0, 3600] s, got 0"),
        (["--scene", "pillow", "--random", "1", "--script", "a"], "cannot both press"),
    ],
)
def test_what_cannot_be_served_is_reported(command, arguments, told):
    result = command("serve", *arguments)
    assert isinstance(result.exception, InputError)
    assert told in str(result.exception)


def test_a_recording_is_played_and_recorded_again_the_same(recording, serve, told, tmp_path):
    sweeps, again = read(recording), tmp_path / "again.nc"
    with serve(instrument(recorded(sweeps, None), pace=0)) as ports:
        control = f"127.0.0.1:{ports.control}"
        where = ["--resource", ports.resource, "--control", control, "-o", again]
        told("record", "pillow", "--repetitions", 2, *where)
    assert list(read(again)["press"].values) == list(sweeps["press"].values)
    assert impedance(read(again)) == pytest.approx(impedance(sweeps), rel=1e-5)


def test_played_sweeps_come_in_turn_and_between_their_frequencies(recording):
    sweeps = read(recording)
    skin = RecordedSkin(sweeps, "left")
    first, second, third = (skin.check("2,1") for _ in range(3))
    assert first == third != second
    between = abs(skin.impedance(first, 2e3))
    assert abs(skin.impedance(first, 4e3)) < between < abs(skin.impedance(first, 1e3))
    with pytest.raises(InputError, match="frequency must be in"):
        skin.impedance(first, 5e4)
    with pytest.raises(InputError, match="press '9,9' was not recorded; recorded are none, 1,1"):
        skin.check("9,9")
    with pytest.raises(InputError, match=re.escape("`interface` must be one of left, got 'up'")):
        RecordedSkin(sweeps, "up")
