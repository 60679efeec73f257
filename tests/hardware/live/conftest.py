"""`rcskin live` at a virtual meter: as a process of its own, or within this one."""

import sys

import pytest
import typer
from rcskin.hardware.control_client import send_request
from rcskin.hardware.live.command import Live
from rcskin.hardware.live.live_baseline import LiveBaseline
from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.live.live_session import LiveSession
from rcskin.hardware.live.session_log import SessionLog
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.record.measured_sweep import SweepLimits
from rcskin.simulator.meters.accuracy_table import read_table
from rcskin.simulator.requests.typer_commands import add_commands
from rcskin.tests.hardware.live import live_rig
from typer.testing import CliRunner


class Witness:
    """Keeps what is shown, and does `then[n]` after the n-th answer."""

    lasting = False

    def __init__(self, then=None):
        self.moments, self.told, self.notes = [], [], []
        self.then = then or {}

    def reading(self, frequency, reading):
        pass

    def answer(self, moment):
        self.moments.append(moment)
        self.then.get(len(self.moments), lambda: None)()

    def no_answer(self, why):
        self.told.append(why)

    def note(self, text):
        self.notes.append(text)

    @property
    def labels(self):
        return [moment.answer.label for moment in self.moments]


@pytest.fixture
def instrument(make_instrument, cushion):
    return make_instrument(cushion)


@pytest.fixture
def cushion():
    return live_rig.SKINS["left"]


@pytest.fixture
def start(spawn, ports):
    """A function that starts the command at the virtual meter, killed at the end if need be."""

    def start(*arguments, resource=ports.resource, **pipes):
        where = ["live", "--model", "m.npz", "--resource", resource]
        return spawn(sys.executable, live_rig.__file__, *where, *arguments, **pipes)

    return start


@pytest.fixture
def live(ports, monkeypatch):
    """A function that runs the command in this process; gives the typer result."""
    monkeypatch.setattr("rcskin.simulator.page.linked.linked_page", live_rig.document)
    monkeypatch.setattr("rcskin.hardware.live.live_localizer.localizer_of", live_rig.localizer_of)
    app = typer.Typer()
    add_commands(app, Live)

    def live(*arguments, model="m.npz"):
        words = ["--resource", ports.resource, "--model", model]
        return CliRunner().invoke(app, [*words, *map(str, arguments)])

    return live


@pytest.fixture
def gather(command):
    """A function that has a log written whose session was cut off; gives the typer result."""
    return lambda log: command("gather", log)


@pytest.fixture
def press(ports):
    """A function that gives a function that presses through the control port."""
    return lambda where: lambda: send_request(f"127.0.0.1:{ports.control}", "press", press=where)


@pytest.fixture
def session(ports):
    """A function that makes a session at the virtual meter, let go at the end."""
    links = []

    def session(
        then=None, *, localizer=None, rest=2, patience=5.0, drift=0.05, switch=None, **more
    ):
        localizer = localizer or live_rig.Columns()
        connect = lambda: open_meter(ports.resource, 0.2)  # noqa: E731
        link = LiveMeter(
            localizer, connect, read_table(), SweepLimits(drift=drift), patience, switch
        )
        links.append(link)
        kept = LiveBaseline(rest if localizer.uses_baseline else 0)
        return LiveSession(localizer, link, kept, Witness(then), SessionLog(), **more)

    yield session
    for link in links:
        link.station.release()


@pytest.fixture
def impatient(monkeypatch):
    """Waits between connections that a test has time for."""
    monkeypatch.setattr("rcskin.hardware.live.live_meter.FIRST_WAIT", 0.01)
