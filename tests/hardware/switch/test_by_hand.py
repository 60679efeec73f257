"""A person, a command and the virtual meter as switches, and how one of them is chosen."""

import re
import shlex
import sys

import pytest
from rcskin.hardware.switch.switch import (
    NoSwitchError,
    RefusedSwitchError,
    SilentSwitchError,
    StuckSwitchError,
)
from rcskin.hardware.switch.switch_options import switch_from_options
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError

BOTH = ("left", "bottom")


@pytest.fixture
def instrument(make_instrument, rig_skins):
    return make_instrument(rig_skins["left"], skins=rig_skins, interface="left")


def commanded(command):
    return switch_from_options(None, command, 0, BOTH)


def test_a_command_gets_the_name_as_one_word_without_a_shell(tmp_path):
    path = tmp_path / "told"
    code = f"import sys; open({str(path)!r}, 'a').write(repr(sys.argv[1:]))"
    switch = switch_from_options(
        None, f"{sys.executable} -c {shlex.quote(code)} {{interface}} '$HOME;ls'", 0, ["a b; c"]
    )
    switch.select("a b; c")
    switch.select("a b; c")
    assert path.read_text() == "['a b; c', '$HOME;ls']"
    assert switch.selected == "a b; c"


@pytest.mark.parametrize(
    "command",
    [
        "",
        " ",
        "turn",
        "turn left",
        "turn {}",
        "turn {0}",
        "turn {name}",
        "turn {interface.x}",
        "turn {interface[0]}",
        "turn {interface!r}",
        "turn {interface:>9}",
        "turn {interface:{interface}}",
        "turn {interface} {press}",
        "turn {interface",
        "turn }{interface}",
        "turn '{interface}",
        "'' {interface}",
    ],
)
def test_a_command_that_cannot_be_filled_in_is_refused(command):
    with pytest.raises(
        InputError, match="`switch-with` must be a command with the placeholder {interface}"
    ):
        commanded(command or " ")


@pytest.mark.parametrize(
    ("command", "name", "message"),
    [
        ("turn {interface}", "-rf", "'-rf' would be an option of turn: rename it, or write --"),
        ("turn {interface}", "--help", "'--help' would be an option"),
        ("turn {interface}.x", "-o", "'-o.x' would be an option"),
        ("turn a {interface}", "-", "'-' would be an option"),
        ("turn -- a; turn {interface}", "ok", None),
        ("turn -- {interface}", "-rf", None),
        ("turn --to={interface}", "-rf", None),
        ("turn {interface}", "-12", None),
        ("turn {interface}", "a b; c & $(d)", None),
        ("turn.BAT {interface}", "a&calc", "'a&calc' would be a command to cmd.exe"),
        ("turn.cmd to:{interface}", '"|calc', "would be a command to cmd.exe"),
        ("turn.cmd to:{interface}", "%PATH%", "would be a command to cmd.exe"),
        ("turn.cmd a&b {interface}", "left", None),
    ],
)
def test_a_name_from_a_scene_is_neither_an_option_nor_a_command(command, name, message):
    """It is refused before the command runs for the first time, wherever it could be obeyed."""
    if message is None:
        assert switch_from_options(None, command, 0, [name, "left"]).positions
        return
    with pytest.raises(InputError, match=re.escape(message)):
        switch_from_options(None, command, 0, ["left", name])


def test_doubled_braces_are_braces(tmp_path):
    commanded(f"touch {tmp_path}/{{{{a}}}}-{{interface}}").select("left")
    assert (tmp_path / "{a}-left").exists()


def test_a_command_that_fails_is_reported_with_its_last_word():
    code = "import sys; print('traceback', file=sys.stderr); sys.exit('relay is hot')"
    with pytest.raises(RefusedSwitchError, match=r"ended with code 1 \(relay is hot\); check"):
        commanded(f"{sys.executable} -c {shlex.quote(code)} {{interface}}").select("left")


def test_a_command_that_is_not_there_is_reported():
    with pytest.raises(NoSwitchError, match="cannot be run"):
        commanded("/nowhere/turn {interface}").select("left")


def test_a_command_that_never_ends_is_ended(monkeypatch):
    monkeypatch.setattr("rcskin.hardware.switch.switch_options.COMMAND_TIMEOUT", 0.1)
    with pytest.raises(SilentSwitchError, match="did not end within 0.1 s"):
        commanded(f"{sys.executable} -c 'import time; time.sleep(9)' {{interface}}").select("left")


def test_a_person_is_asked_only_to_change():
    asked = []
    switch = switch_from_options("ask", None, 0, BOTH, asked.append)
    for name in ("left", "left", "bottom", "left"):
        switch.select(name)
    assert asked == ["left", "bottom", "left"]


def test_a_person_who_ends_it_has_connected_nothing():
    def ask(name):
        raise KeyboardInterrupt

    switch = switch_from_options("ask", None, 0, BOTH, ask)
    with pytest.raises(KeyboardInterrupt):
        switch.select("left")
    assert switch.selected is None


def test_the_virtual_meter_is_switched_and_left_as_found(ports, instrument):
    switch = switch_from_options(f"127.0.0.1:{ports.control}", None, 0, BOTH)
    switch.select("bottom")
    assert instrument.interface == "bottom"
    switch.close()
    assert instrument.interface == "left"


def test_a_late_virtual_switch_is_awaited(ports, instrument):
    switch = switch_from_options(f"127.0.0.1:{ports.control}", None, 0, BOTH)
    instrument.faults.add(Fault("slow", seconds=0.2))
    switch.select("bottom")
    assert instrument.interface == "bottom"


def test_a_stuck_virtual_switch_is_reported(ports, instrument):
    switch = switch_from_options(f"127.0.0.1:{ports.control}", None, 0, BOTH)
    switch.patience = 0.05
    instrument.faults.add(Fault("stuck"))
    with pytest.raises(
        StuckSwitchError, match="reports position left after .* instead of interface bott"
    ):
        switch.select("bottom")
    switch.select("bottom")
    assert instrument.interface == "bottom"


def test_an_absent_virtual_meter_is_reported():
    with pytest.raises(NoSwitchError, match="no virtual meter answers at 127.0.0.1:1"):
        switch_from_options("127.0.0.1:1", None, 0, BOTH).select("left")


def test_an_interface_that_the_virtual_skin_lacks_is_bad_input(ports):
    switch = switch_from_options(f"127.0.0.1:{ports.control}", None, 0, ["top"])
    with pytest.raises(InputError, match="the skin has the interfaces left, bottom, got 'top'"):
        switch.select("top")


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "switch.toml"
    path.write_text('kind = "lcus"\nport = "/dev/null"\n[interface]\nleft = [1]\ntop = [2]\n')
    return str(path)


def test_one_interface_needs_no_switch():
    assert switch_from_options(None, None, None, ["left"]) is None


def test_the_settle_time_is_the_tables_unless_asked_for(table):
    assert switch_from_options(table, None, None, ["left"]).settle == 0.02
    assert switch_from_options(table, None, 0.5, ["left"]).settle == 0.5
    assert switch_from_options("127.0.0.1:1", None, None, ["left"]).settle == 0.05


@pytest.mark.parametrize(
    ("name", "command", "settle", "told"),
    [
        (None, None, None, "the interfaces left, bottom need a switch that works without a person"),
        ("ask", None, None, "need a switch that works without a person"),
        ("a.toml", "turn {interface}", None, "`switch` and `switch-with` cannot both"),
        ("nowhere.toml", None, None, "nowhere.toml: no such file"),
        ("anything", None, None, "`switch` must be TABLE.toml, HOST:PORT or ask, got 'anything'"),
        ("1.2.3.4:99999", None, None, "`switch` must be TABLE.toml, HOST:PORT or ask"),
        ("1.2.3.4:1", None, -1, r"`settle` must be in \[0, 3600\] s, got -1"),
        ("1.2.3.4:1", None, float("nan"), r"`settle` must be in \[0, 3600\] s, got nan"),
    ],
)
def test_what_cannot_be_is_bad_input(name, command, settle, told):
    with pytest.raises(InputError, match=told):
        switch_from_options(name, command, settle, BOTH)


def test_a_table_without_an_interface_of_the_scene_is_bad_input(table):
    with pytest.raises(InputError, match="lacks the interface bottom; it has left, top"):
        switch_from_options(table, None, None, BOTH)
