"""The virtual reader, the recorder and live sessions: lines over a socket, and their faults."""

import json
import socket
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from rcskin.hardware.live.live_baseline import LiveBaseline
from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.live.live_session import LiveSession
from rcskin.hardware.live.session_log import SessionLog
from rcskin.hardware.reader.line_format import LineFormat
from rcskin.hardware.record.managed_meter import SourceOptions, source_setup
from rcskin.hardware.record.measured_sweep import SweepLimits
from rcskin.hardware.record.operators import MachineOperator, press_virtual_skin, standard_order
from rcskin.hardware.record.recorder import RecordingTask, record
from rcskin.hardware.record.recording_journal import recording_dataset
from rcskin.hardware.record_command import header_of
from rcskin.hardware.virtual import served_skin
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.hardware.virtual.recorded_skin import exact_readout
from rcskin.hardware.virtual.virtual_device import ON_LINES, Fault
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, impedance, inputs, read
from rcskin.tests.hardware.live.live_rig import SKINS, Pixels
from rcskin.tests.hardware.pillow import Silent
from rcskin.tests.hardware.reader.reader_files import ARRAYS, COUNTED

READING = "a line for each reading"
FORMATS = {READING: COUNTED, "a line for each sweep": ARRAYS}
INTERFACES = ("left", "bottom")


@pytest.fixture
def quilt():
    """A scene with two interfaces."""
    return load_scene(str(Path(__file__).parents[1] / "scenes" / "quilt.toml"))


@pytest.fixture
def described(tmp_path):
    """A function that writes a reader's file."""

    def described(text, *lines):
        path = tmp_path / "reader.toml"
        head, mark, tables = text.partition("[[interface]]")
        path.write_text("\n".join([head, *lines, mark + tables]))
        return path

    return described


@contextmanager
def served(scene, skins, text, **more):
    """The virtual reader of these skins, and its ports."""
    skin = served_skin.ServedSkin(skins, exact_readout, *scene.pixels.shape, 1e3, scene.parts)
    line_format = LineFormat.model_validate({**inputs.tables(text), **more})
    device = served_skin.reader(skin, line_format)
    with run_in_thread(device) as ports:
        yield device, ports


def recorded(scene, ports, path, tmp_path, **more):
    """A recording through the command's own set-up: sweeps, what was noted, and what was shown."""
    notes, show = [], Silent()
    header = header_of(scene.parts, INTERFACES, standard_order(*scene.pixels.shape, 1)[:4])
    options = SourceOptions(ports.line_resource, 1.0, 9600, None, path)
    source = source_setup(
        options, header.by_interface, report=lambda kind, text: notes.append(kind)
    )
    task = RecordingTask(
        header,
        tmp_path / "run.nc",
        source.connect,
        source.table,
        SweepLimits(two_terminal=source.checks_laws),
        switch=source.terminals,
        conditions=source.conditions,
    )
    press = press_virtual_skin(f"127.0.0.1:{ports.control}")
    operator = MachineOperator(press, show, retries=3, pause=0)
    for name, value in more.items():
        setattr(operator, name, value)
    return recording_dataset(*record(task, operator)), notes, show


def exact(scene, skins, presses):
    """Z in ohm of every press, shape (sweep, interface, frequency)."""
    f = scene.frequencies.tolist()
    return [[[skins[n].impedance(p, each) for each in f] for n in INTERFACES] for p in presses]


def test_its_lines_hold_the_skin_as_a_person_reads_them(quilt, rig_skins):
    with served(quilt, rig_skins, COUNTED) as (_, ports):
        with socket.create_connection(("127.0.0.1", ports.meter), timeout=5) as line:
            lines = [text.rstrip("\n") for text, _ in zip(line.makefile(), range(8), strict=False)]
    assert lines[0] == "# rcskin virtual reader"
    rows = [line.split(",") for line in lines[1:]]
    assert [int(row[0]) for row in rows] == list(range(7))
    frequencies = quilt.frequencies.tolist()
    for row, label, name in ((rows[0], "A", "left"), (rows[len(frequencies)], "B", "bottom")):
        Z = rig_skins[name].impedance("none", frequencies[0])
        assert row[2] == label and float(row[3]) == frequencies[0]
        assert complex(float(row[4]), float(row[5])) == pytest.approx(Z, rel=1e-8)


@pytest.mark.parametrize("name", FORMATS)
def test_a_recording_holds_every_press_at_all_terminals(
    quilt, rig_skins, described, tmp_path, name
):
    path = described(FORMATS[name])
    with served(quilt, rig_skins, FORMATS[name]) as (_, ports):
        sweeps, notes, show = recorded(quilt, ports, path, tmp_path)
    presses = [str(each) for each in sweeps["press"].values]
    np.testing.assert_allclose(impedance(sweeps), exact(quilt, rig_skins, presses), rtol=1e-7)
    assert (notes, show.remarks, sweeps.attrs["model"]) == ([], [], "virtual meter")
    assert json.loads(sweeps.attrs["settings"])["rate"]


@pytest.mark.parametrize("kind", ON_LINES)
@pytest.mark.parametrize("name", FORMATS)
def test_a_fault_never_becomes_a_wrong_sweep(quilt, rig_skins, described, tmp_path, name, kind):
    """The fault hits two sweeps on end, in the middle of a recording."""
    path = described(FORMATS[name])
    with served(quilt, rig_skins, FORMATS[name]) as (device, ports):
        pressed, by = [], press_virtual_skin(f"127.0.0.1:{ports.control}")

        def press(step):
            by(step)
            pressed.append(step)
            if len(pressed) == 2:
                times = {"drop": 1, "restart": 2}.get(kind, 24 if name == READING else 4)
                device.faults.add(Fault(kind, times=times, seconds=0.002))

        sweeps, notes, show = recorded(quilt, ports, path, tmp_path, press_skin=press)
        assert device.faults.waiting == []
    presses = [str(each) for each in sweeps["press"].values]
    np.testing.assert_allclose(impedance(sweeps), exact(quilt, rig_skins, presses), rtol=1e-7)
    unseen = ("late", "silent", "half", "endless")  # between two requests; skipped unread
    if name == READING and kind not in unseen:
        assert notes or show.remarks


def test_a_live_session_reads_lines(described, press_control):
    localizer = Pixels()
    text = COUNTED.replace("rate = 2000", "rate = 1000")
    path = described(text)
    with served(localizer.parts.scene, SKINS, text) as (_, ports):
        press = press_control(ports)
        frequencies = dict.fromkeys(INTERFACES, localizer.frequencies)
        options = SourceOptions(ports.line_resource, 1.0, 9600, None, path)
        source = source_setup(options, frequencies, follows=True)
        meter = LiveMeter(
            localizer,
            source.connect,
            source.table,
            SweepLimits(two_terminal=source.checks_laws),
            5.0,
            source.terminals,
            conditions=source.conditions,
        )
        display = Witness({1: press("1,2"), 3: press("2,3")})
        session = LiveSession(localizer, meter, LiveBaseline(2), display, SessionLog())
        try:
            session.run(5)
        finally:
            meter.station.release()
    assert (display.labels[2], display.labels[4]) == ("pixel 1,2", "pixel 2,3")
    assert session.failed == 0


class Witness:
    """Keeps the answers, and does `then[n]` after the n-th."""

    def __init__(self, then):
        self.labels, self.then = [], then

    def reading(self, frequency, reading): ...
    def no_answer(self, why): ...
    def note(self, text): ...
    def answer(self, moment):
        self.labels.append(moment.answer.label)
        self.then.get(len(self.labels), lambda: None)()


@pytest.fixture
def press_control():
    """A function that gives a function that presses through the control port."""
    from rcskin.hardware.control_client import send_request

    def at(ports):
        return lambda where: (
            lambda: send_request(f"127.0.0.1:{ports.control}", "press", press=where)
        )

    return at


TCP = "tcp:127.0.0.1:9"
REFUSED = {
    "no file": ((TCP,), "needs --reader FILE.toml"),
    "no port": (("tcp:host", "--reader", "reader.toml"), "must be tcp:HOST:PORT"),
    "a meter": (
        ("TCPIP0::1.1.1.1::1::SOCKET", "--interface", "left", "--reader", "reader.toml"),
        "describes lines of",
    ),
    "a setting": ((TCP, "--reader", "reader.toml", "--speed", "FAST"), "no setting `speed`"),
    "a switch": ((TCP, "--reader", "reader.toml", "--switch", "s.toml"), "all its terminals"),
    "a table": ((TCP, "--reader", "reader.toml", "--accuracy", "a.toml"), "a table of a meter"),
    "an interface": ((TCP, "--reader", "other.toml"), "other.toml: the reader's file lacks"),
    "an absent file": ((TCP, "--reader", "absent.toml"), "absent.toml"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_options_that_do_not_fit_a_reader_are_refused(command, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "reader.toml").write_text(COUNTED)
    (tmp_path / "other.toml").write_text(COUNTED.replace('name = "bottom"', 'name = "top"'))
    given, message = REFUSED[name]
    result = command("record", "quilt", "--resource", *given, "-o", tmp_path / "run.nc", input="")
    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)


def test_the_virtual_reader_refuses_what_it_cannot_send(quilt, rig_skins):
    listed = ARRAYS.replace('frequency = "khz"\nfrequency_scale = 1e3', "frequencies = [5.0, 7.0]")
    with pytest.raises(InputError, match="must be those of the scene"):
        with served(quilt, rig_skins, listed):
            pass


GAINS = """
name = "knit board"
format = "csv"
columns = ["n", "f", "a", "b"]
count = "n"
frequency = "f"
quantity = "gain"
unit = "bit"
scale = 1e-4
amplitude = 2.0
rate = 2000
[[interface]]
name = "left"
magnitude = "a"
[[interface]]
name = "right"
magnitude = "b"
"""
"""Two magnitudes in a line, in bits of 0.1 mV of a source of 2 V."""


class Bends:
    """A skin whose gain falls at a press."""

    def check(self, press):
        return press

    def hold(self, press, now):
        return press

    def momentary(self, press, at):
        return press

    def impedance(self, press, frequency):
        """V / V_s."""
        return complex(0.9, -0.1) * (1 if press == "none" else 0.8) / (1 + frequency / 1e5)


def test_gains_are_recorded_as_such(command, described, tmp_path):
    """Bits become gains; phases that the scene does not read are not stored."""
    scene = load_scene("knit-36")
    path, order = described(GAINS), tmp_path / "order.txt"
    order.write_text("none\nnone\n1,5\n")
    skins = {"left": Bends(), "right": Bends()}
    with served(scene, skins, GAINS) as (_, ports):
        where = ["--resource", ports.line_resource, "--reader", path, "--order", order]
        control = f"127.0.0.1:{ports.control}"
        result = command("record", "knit-36", *where, "--control", control, "-o", tmp_path / "a.nc")
    assert result.exception is None, result.output
    sweeps = read(tmp_path / "a.nc")
    assert set(sweeps.data_vars) == {"gain"}
    f = sweeps["frequency"].values
    expected = [[abs(Bends().impedance(press, f))] * 2 for press in ("none", "none", "1,5")]
    np.testing.assert_allclose(sweeps["gain"].values, expected, atol=0.51e-4 / 2)


@pytest.mark.parametrize(
    ("scene", "text", "message"),
    [
        ("quilt", GAINS, "describes lines of the magnitude of the gain, and the scene reads the"),
        ("knit-36", COUNTED, "describes lines of the impedance, and the scene reads the magnitude"),
    ],
)
def test_a_reader_of_another_quantity_is_refused(
    command, described, tmp_path, scene, text, message
):
    given = ["--resource", TCP, "--reader", described(text), "-o", tmp_path / "run.nc"]
    result = command("record", scene, *given, input="")
    assert isinstance(result.exception, InputError) and message in str(result.exception)


def multisine_quilt(scene):
    """The scene with a multisine reader and no other noise."""
    readers = {f"interface.{each.name}.reader": "multisine" for each in scene.interfaces}
    electronics = {"feedback_resistance": 1e4, "frame": 8e-3, "frames": 2}
    return scene.with_({**readers, "readout": {"multisine": electronics}})


def test_a_multisine_sends_whole_frames_no_faster_than_it_reads_them(quilt, tmp_path):
    scene = multisine_quilt(quilt)
    skin = served_skin.simulated(scene.parts, seed=1)
    text = ARRAYS.replace("rate = 200", "rate = {}")
    with pytest.raises(InputError, match=r"`rate` .* must be <= 31\.25 lines per second, as a sw"):
        served_skin.reader(skin, LineFormat.model_validate(inputs.tables(text.format(32))))
    device = served_skin.reader(skin, LineFormat.model_validate(inputs.tables(text.format(31.25))))
    with run_in_thread(device) as ports, socket.create_connection(("127.0.0.1", ports.meter)) as s:
        lines = s.makefile()
        lines.readline()
        sent = [json.loads(lines.readline()) for _ in range(3)]
    assert [each["id"] for each in sent] == [0, 1, 2]
    assert all(np.allclose(1e3 * np.array(each["khz"]), scene.frequencies) for each in sent)


def test_a_meter_of_a_multisine_scene_notes_that_it_reads_in_its_own_time(quilt):
    skin = served_skin.simulated(multisine_quilt(quilt).parts, seed=1)
    meter = served_skin.instrument(skin, pace=0)
    (note,) = served_skin.notes(meter, skin)
    meter.worker.end()
    assert "reads one frequency after the other in its own time; --reader FILE" in note
