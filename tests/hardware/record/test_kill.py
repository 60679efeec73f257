"""A recording that is killed at any point loses no finished sweep."""

import signal
import time

import pytest
from rcskin.hardware.record.journal import Journal
from rcskin.hardware.record.order import standard_order
from rcskin.simulator.sweeps import read, violations

REPETITIONS = 20


def finished(folder):
    return {path.name: path.read_bytes() for path in folder.glob("0*.json")}


def test_killed_again_and_again_it_goes_on_and_loses_nothing(ports, start_rig, tmp_path):
    output = tmp_path / "run.nc"
    folder = Journal(output).folder
    arguments = ["record", "pillow", "--resource", ports.resource, "-o", output]
    arguments += ["--control", f"127.0.0.1:{ports.control}", "--repetitions", REPETITIONS]
    kept = {}
    for enough in (1, 20, 50):
        process = start_rig(*arguments)
        while len(finished(folder)) < enough:
            assert process.poll() is None, process.stderr.read()
            time.sleep(0.002)
        process.kill()
        process.communicate()
        now = finished(folder)
        assert kept.items() <= now.items()
        assert not output.exists()
        kept = now
    process = start_rig(*arguments)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert kept.items() <= finished(folder).items()
    sweeps = read(output)
    order = standard_order(2, 2, REPETITIONS)
    assert list(sweeps["press"].values) == [step.press for step in order]
    assert violations(sweeps, 1e-5) == []
    assert out == f"{len(order)} sweeps x 3 frequencies -> {output}; 0 with remarks\n"


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_a_served_meter_ends_when_it_is_told(start_rig, end):
    process = start_rig("serve", "--scene", "pillow", "--port", 0, "--control-port", 0)
    assert "TCPIP0::127.0.0.1::" in process.stdout.readline()
    process.send_signal(end)
    _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
