"""A lab's Windows computer: what the meter's commands do there otherwise than on Unix."""

import signal
import sys
from types import SimpleNamespace

import pytest
import pyvisa
from rcskin.hardware.command_template import CommandTemplate
from rcskin.hardware.live.live_screen import key_reader
from rcskin.hardware.meter.conversation import connect
from rcskin.hardware.meter.errors import NoConnectionError
from rcskin.hardware.meter.instruments import find_resources
from rcskin.hardware.virtual.serving import serve as serve_until_signal
from rcskin.simulator.sweeps import read


def test_a_recording_ends_whole_where_open_files_stay(windows, command, ports, tmp_path):
    (tmp_path / "order.txt").write_text("none\n1,1\nnone\n")
    where = ["--resource", ports.resource, "--control", f"127.0.0.1:{ports.control}"]
    more = ["--order", tmp_path / "order.txt", "-o", tmp_path / "a.nc"]
    assert command("record", "pillow", *where, *more).exit_code == 0
    assert read(tmp_path / "a.nc").sizes["sweep"] == 3
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "order.txt"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_virtual_meter_where_loops_take_none(windows, make_instrument, number):
    before = signal.getsignal(number)
    told = lambda ports: signal.raise_signal(number)  # noqa: E731
    serve_until_signal(make_instrument(), (), told, port=0, control_port=0)
    assert signal.getsignal(number) is before


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (r"C:\lab\press.exe {press}", [r"C:\lab\press.exe", "2,3"]),
        (r'"C:\Program Files\press.exe" --at={press}', [r"C:\Program Files\press.exe", "--at=2,3"]),
        (r"\\server\lab\press.exe {press}", [r"\\server\lab\press.exe", "2,3"]),
        (r"python C:\lab\new.py {press}", ["python", r"C:\lab\new.py", "2,3"]),
        pytest.param(
            r"/opt/my\ lab/press {press}",
            ["/opt/my lab/press", "2,3"],
            marks=pytest.mark.posix("there a backslash is always part of a path"),
        ),
    ],
)
def test_a_path_of_windows_in_a_command_keeps_its_backslashes(command, words):
    assert CommandTemplate(command, "press-with", press="none").filled(press="2,3") == words


@pytest.mark.parametrize(
    ("resource", "chosen", "backend"),
    [
        ("TCPIP0::127.0.0.1::3500::SOCKET", None, "@py"),
        ("ASRL3::INSTR", None, "@py"),
        ("GPIB0::1::INSTR", None, ""),
        ("USB0::0x3423::0x0001::1::INSTR", None, ""),
        ("ASRL3::INSTR", "@ivi", ""),
    ],
)
def test_what_pyvisa_py_does_not_reach_by_itself_goes_through_pyvisas_choice(
    monkeypatch, resource, chosen, backend
):
    """That is NI-VISA where it is installed, and what PYVISA_LIBRARY says before all."""
    taken = []

    def open_resource(*arguments, **options):
        raise OSError("no driver")

    def manager(backend):
        taken.append(backend)
        return SimpleNamespace(open_resource=open_resource)

    monkeypatch.setattr(pyvisa, "ResourceManager", manager)
    monkeypatch.delenv("PYVISA_LIBRARY", raising=False)
    if chosen:
        monkeypatch.setenv("PYVISA_LIBRARY", chosen)
    with pytest.raises(NoConnectionError, match="cannot be opened .no driver.; check the address"):
        connect(resource)
    assert taken == [backend]


def test_resources_of_every_backend_are_found(monkeypatch):
    found = {"@py": ("ASRL3::INSTR",), "": ("ASRL3::INSTR", "GPIB0::1::INSTR")}
    manager = lambda backend: SimpleNamespace(list_resources=lambda kind: found[backend])  # noqa: E731
    monkeypatch.setattr(pyvisa, "ResourceManager", manager)
    monkeypatch.delenv("PYVISA_LIBRARY", raising=False)
    assert find_resources() == ["ASRL3::INSTR", "GPIB0::1::INSTR"]


@pytest.mark.parametrize(
    ("typed", "key"), [("", ""), ("Q", "q"), ("ar", "r"), ("a\xe0H", ""), ("\0;q", "q")]
)
def test_keys_come_from_windows_console(windows, monkeypatch, typed, key):
    """An arrow is a prefix and a code there, which is no key of the session's."""
    waiting = list(typed)
    console = SimpleNamespace(kbhit=lambda: bool(waiting), getwch=lambda: waiting.pop(0))
    monkeypatch.setitem(sys.modules, "msvcrt", console)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    with key_reader() as last:
        assert last() == key
