"""A recording of a pillow by a machine, and what it shows."""

import pytest
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.operators import MachineOperator, press_virtual_skin, standard_order
from rcskin.hardware.record.recorder import RecordingTask
from rcskin.hardware.record_command import header_of
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.tests.hardware.pillow import Silent


@pytest.fixture
def show():
    return Silent()


@pytest.fixture
def operator(ports, show):
    return MachineOperator(
        press_virtual_skin(f"127.0.0.1:{ports.control}"), show, retries=3, pause=0
    )


@pytest.fixture
def task(ports, scene, tmp_path):
    return RecordingTask(
        header_of(scene.parts, ["left"], standard_order(2, 2, 2)),
        tmp_path / "run.nc",
        lambda: open_meter(ports.resource, 0.5),
        read_table(),
    )
