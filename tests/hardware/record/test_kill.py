"""A recording that is killed at any point loses no finished sweep."""

import json
import re
import signal
import socket
import sys
import time

import pytest
from rcskin.hardware.record.operators import standard_order
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import read, violations

SOON = 30
"""Seconds that the end may take on a very busy machine; alone it takes half a second."""

REPETITIONS, SWEEPS = 20, "0*.json"


def finished(folder):
    return {path.name: path.read_bytes() for path in folder.glob(SWEEPS)}


def test_killed_again_and_again_it_goes_on_and_loses_nothing(ports, start_rig, tmp_path):
    output = tmp_path / "run.nc"
    folder = RecordingJournal(output).folder
    arguments = ["record", "pillow", "--resource", ports.resource, "-o", output]
    arguments += ["--control", f"127.0.0.1:{ports.control}", "--repetitions", REPETITIONS]
    kept = {}
    for enough in (1, 30):
        process = start_rig(*arguments)
        while sum(1 for _ in folder.glob(SWEEPS)) < enough:
            assert process.poll() is None, process.stderr.read()
            time.sleep(0.01)
        process.kill()
        process.communicate()
        now = finished(folder)
        assert kept.items() <= now.items()
        assert not output.exists()
        kept = now
    process = start_rig(*arguments)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0
    earth, put_back = err.splitlines()
    assert "the scene has no [surroundings]" in earth
    assert re.fullmatch(
        rf"rcskin: note: {folder}: .* the original ones at its end: header = .*", put_back
    )
    sweeps = read(output)
    assert not folder.exists()
    first = sorted(kept)
    Rs = [json.loads(kept[name])["sweep"]["traces"][0]["Rs"] for name in first]
    assert sweeps["Rs"].values[[int(name[:6]) for name in first], 0].tolist() == Rs
    order = standard_order(2, 2, REPETITIONS)
    assert list(sweeps["press"].values) == [step.press for step in order]
    assert violations(sweeps, 1e-5) == []
    assert out == f"{len(order)} sweeps x 3 frequencies -> {output}; 0 with remarks\n"


TOLD = pytest.mark.posix("there one process ends another without a word to it")


@TOLD
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_a_served_meter_ends_on_request(start_rig, end):
    process = start_rig("serve", "--scene", "pillow", "--port", 0, "--control-port", 0)
    assert "TCPIP0::127.0.0.1::" in process.stdout.readline()
    process.send_signal(end)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0
    assert all(line.startswith("rcskin: note:") for line in err.splitlines())


SLOW = """
import time
from rcskin.tests.hardware import pillow, rig
def impedance(self, press, frequency):
    if frequency != {quick}:
        print("solving", flush=True)
        time.sleep(60)
    return 1e3 - 1e3j
pillow.Pillow.impedance = impedance
rig.run(["serve", "--scene", "pillow", "--port", "0", "--control-port", "0"])
"""


@pytest.fixture
def slow_meter(spawn):
    """A function that serves a skin which is solved at once at one frequency alone, in Hz."""
    return lambda quick: spawn(sys.executable, "-c", SLOW.format(quick=quick))


@TOLD
def test_a_meter_ends_while_its_first_reading_is_solved(slow_meter):
    process = slow_meter(quick=0)
    assert process.stdout.readline() == "solving\n"
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=SOON)
    assert process.returncode == 130 and err == "rcskin: interrupted\n"


@TOLD
def test_a_meter_ends_while_a_client_awaits_a_reading(slow_meter):
    process = slow_meter(quick=1e3)
    port = process.stdout.readline().split("::")[2]
    with socket.create_connection(("127.0.0.1", int(port)), timeout=5) as line:
        line.sendall(b":TRIGger EXTernal;:FREQuency 5E3;*TRG;:MEASure?\r\n")
        assert process.stdout.readline() == "solving\n"
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=SOON)
    assert process.returncode == 0


@TOLD
def test_ctrl_c_ends_a_recording_that_awaits_the_meter_and_says_how_to_go_on(
    start_rig, serve, make_instrument, tmp_path
):
    meter = make_instrument()
    with serve(meter) as ports:
        output = tmp_path / "run.nc"
        order = tmp_path / "order.txt"
        order.write_text("none\n" * 500)
        where = ["--resource", ports.resource, "--order", order, "-o", output, "--unattended"]
        process = start_rig("record", "pillow", *where, "--timeout", 60)
        folder = RecordingJournal(output).folder
        while len(finished(folder)) < 1:
            time.sleep(0.002)
        meter.faults.add(Fault("silent", times=10**6))
        while meter.faults.waiting[0].times == 10**6:
            assert process.poll() is None
            time.sleep(0.002)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=SOON)
    kept = len(finished(folder))
    told = (
        f"rcskin: {kept} of 500 sweeps are kept in {folder}; the same command continues after them"
    )
    assert told in err and "Traceback" not in err and process.returncode != 0
