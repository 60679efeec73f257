"""Virtual meters on the skin of the rig, and scripted ones."""

import asyncio
import json
import socket
import subprocess
import sys
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.virtual.hioki import VirtualHioki
from rcskin.hardware.virtual.instrument import answer
from rcskin.hardware.virtual.measurement import MeasurementSetup
from rcskin.hardware.virtual.meter_server import ControlPort, run_in_thread
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.tests.hardware import rig
from rcskin.tests.hardware.instrument_cases import hioki
from rcskin.tests.hardware.pillow import SKINS, Pillow
from typer.testing import CliRunner
from websockets.sync.client import connect

TIMEOUT = 0.5


class Scripted:
    """A connection that expects messages in order and gives the written answers."""

    resource = "SCRIPT"

    def __init__(self, pairs):
        self._pairs, self.closed = list(pairs), False
        self._answers = []

    def write(self, message):
        expected, answer = self._pairs.pop(0)
        assert message == expected
        self._answers = [answer] if answer is not None else []

    def read(self, seconds=0.0):
        return self._answers.pop(0)

    def close(self):
        self.closed = True


class Looking:
    """A viewer of a page that takes each frame, and may press."""

    def __init__(self, socket):
        self._socket = socket

    def state(self):
        """The next one that is shown."""
        return self._next(lambda said: "frame" in said)["state"]

    def until(self, true):
        """The first state of which something is true."""
        while not true(state := self.state()):
            pass
        return state

    def press(self, text):
        """What is answered."""
        self._socket.send(json.dumps({"do": "press", "press": text}))
        return self._next(lambda said: "do" in said)

    def _next(self, wanted):
        while True:
            said = json.loads(self._socket.recv(timeout=60))
            if "frame" in said:
                self._socket.send(json.dumps({"do": "seen", "frame": said["frame"]}))
            if wanted(said):
                return said


@pytest.fixture
def look():
    """A context with a viewer of the page at an address."""

    @contextmanager
    def look(url):
        origin, _, token = url.partition("/?")
        link = f"{origin.replace('http', 'ws')}/link?{token}"
        with connect(link, origin=origin, compression=None) as socket:
            yield Looking(socket)

    return look


@pytest.fixture
def rig_skins():
    """The pillow at both interfaces."""
    return SKINS


@pytest.fixture
def pillow():
    return Pillow()


@pytest.fixture(scope="session")
def make_instrument():
    """A virtual meter that takes no time, on the pillow unless told otherwise."""

    def make_instrument(skin=None, readout=exact_readout, kind=VirtualHioki, **more):
        return kind(
            MeasurementSetup(skin or Pillow(), readout, read_table()), **{"pace": 0.0, **more}
        )

    return make_instrument


@pytest.fixture
def as_found():
    """Settings of an IM3523 that no command here leaves untouched, each range with its own."""
    return hioki()


@pytest.fixture
def instrument(make_instrument):
    return make_instrument()


@pytest.fixture
def ports(instrument):
    """Where the virtual meter listens."""
    with run_in_thread(instrument) as ports:
        yield ports


@pytest.fixture
def meter(ports):
    """The driver, connected to the virtual meter."""
    with open_meter(ports.resource, TIMEOUT) as meter:
        yield meter


@pytest.fixture
def serve():
    """A context with any instrument served."""
    return lambda instrument, *routines: run_in_thread(
        instrument, ControlPort(instrument, routines)
    )


@pytest.fixture
def say(instrument):
    """What the virtual meter answers to lines, in one event loop."""

    def say(*lines, to=None):
        async def all_lines():
            return [await answer(to or instrument, line) for line in lines]

        return asyncio.run(all_lines())

    return say


@pytest.fixture
def script():
    """A connection with a conversation that must be had to its end."""

    @contextmanager
    def script(*pairs):
        connection = Scripted(pairs)
        yield connection
        assert connection._pairs == []

    return script


@pytest.fixture
def raw():
    """A plain socket to a port, and all that comes back before it falls silent or closes."""

    def raw(port, *sent, wait=1.0):
        with closing(socket.create_connection(("127.0.0.1", port), timeout=wait)) as line:
            for each in sent:
                line.sendall(each)
            line.shutdown(socket.SHUT_WR)
            received = b""
            while part := line.recv(65536):
                received += part
            return received

    return raw


@pytest.fixture
def scene():
    """The pillow's scene: 2 x 2 pixels, 3 frequencies."""
    return load_scene(str(Path(__file__).parent / "scenes" / "pillow.toml"))


@pytest.fixture
def command(monkeypatch):
    """Runs the rig's command line in this process; gives the typer result."""
    for name, toy in rig.TOYS.items():
        monkeypatch.setattr(f"rcskin.{name}", toy)
    return lambda *given, **more: CliRunner().invoke(rig.app, rig.arguments(given), **more)


@pytest.fixture
def spawn():
    """Starts processes, killed at the end if need be."""
    started = []

    def spawn(*words, **pipes):
        pipes = pipes or {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        started.append(subprocess.Popen([*map(str, words)], text=True, **pipes))
        return started[-1]

    yield spawn
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def start_rig(spawn):
    """Starts the rig's command line as a process of its own."""
    return lambda *arguments: spawn(sys.executable, rig.__file__, *arguments)
