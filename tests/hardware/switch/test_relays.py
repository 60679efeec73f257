"""Relay boards, each a state machine at the other end of a real serial line."""

import pytest
from rcskin.hardware.switch.boards import read_switch
from rcskin.hardware.switch.switch import (
    GarbledSwitchError,
    NoSwitchError,
    SilentSwitchError,
    StuckSwitchError,
)
from rcskin.simulator.sweeps import InputError
from rcskin.tests.hardware.switch.boards import LcusBoard, NumatoBoard, on_a_line, soon

KINDS = {"numato": NumatoBoard, "lcus": LcusBoard}


@pytest.fixture
def described(tmp_path):
    """A function that writes a table of a switch: left at relays 1, 2; bottom at 3."""

    def described(kind, port, *lines):
        path = tmp_path / "switch.toml"
        path.write_text(
            "\n".join(
                [
                    f'kind = "{kind}"',
                    f'port = "{port}"',
                    "settle = 0",
                    "timeout = 0.3",
                    *lines,
                    "[interface]",
                    "left = [1, 2]",
                    "bottom = [3]",
                ]
            )
        )
        return path

    return described


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.fixture
def board(kind):
    return KINDS[kind]()


@pytest.fixture
def switch(kind, board, described):
    with on_a_line(board) as port:
        switch = read_switch(described(kind, port))
        yield switch
        switch.close()


def test_an_interface_is_its_relays_and_no_others_of_the_switch(switch, board):
    board.on = {0}
    switch.select("left")
    assert (board.on, switch.selected) == ({0, 1, 2}, "left")
    switch.select("bottom")
    assert (board.on, switch.selected) == ({0, 3}, "bottom")


def test_nothing_is_joined_in_passing(switch, board):
    """What is left is opened before what comes is closed."""
    switch.select("left")
    board.turns.clear()
    switch.select("bottom")
    states = [on for _, on in board.turns]
    assert states == sorted(states) and True in states


def test_what_is_connected_is_not_turned_again_unless_someone_else_turned_it(switch, board):
    switch.select("left")
    board.turns.clear()
    switch.select("left")
    assert board.turns == []
    board.on = {3}
    switch.select("left")
    assert board.on == {1, 2}


def test_a_relay_that_someone_turns_meanwhile_is_reported(switch, board):
    switch.select("left")
    switch.check_stayed()
    board.on = {3}
    with pytest.raises(StuckSwitchError, match=r"turned to \(3\) while interface left"):
        switch.check_stayed()
    switch.check_stayed()
    switch.select("left")
    assert board.on == {1, 2}


def test_it_is_left_as_it_was_found(switch, board):
    board.on = {3}
    switch.select("left")
    switch.close()
    assert soon(lambda: board.on == {3})


def test_a_late_relay_is_awaited(switch, board):
    board.slow = 0.1
    switch.select("left")
    assert board.on == {1, 2}


@pytest.mark.parametrize(
    ("mood", "error", "told"),
    [
        ("silent", SilentSwitchError, r"no answer within 0.3 s; check the board's power"),
        ("garbage", GarbledSwitchError, "is no complete answer of such a board; check `kind`"),
        ("half", GarbledSwitchError, "is no complete answer of such a board"),
        ("stuck", StuckSwitchError, r"instead of interface left, position \(1, 2\); check its p"),
    ],
)
def test_a_fault_is_a_named_error_and_the_next_select_begins_anew(switch, board, mood, error, told):
    switch.select("bottom")
    board.mood = mood
    with pytest.raises(error, match=told):
        switch.select("left")
    assert switch.selected is None
    board.mood = ""
    switch.select("left")
    assert board.on == {1, 2}


def test_an_unplugged_board_is_reported(switch, board):
    switch.select("left")
    board.unplug()
    with pytest.raises(NoSwitchError, match="the line is lost|cannot be opened"):
        switch.select("bottom")


def test_a_port_that_is_not_there_is_reported(kind, described):
    with pytest.raises(NoSwitchError, match="/dev/nowhere: cannot be opened"):
        read_switch(described(kind, "/dev/nowhere")).select("left")


def test_a_board_without_read_back_is_believed(described):
    board = LcusBoard()
    with on_a_line(board) as port:
        switch = read_switch(described("lcus", port, 'query = ""'))
        switch.select("left")
        board.turns.clear()
        switch.select("left")
        assert board.turns == []
        switch.select("bottom")
        assert soon(lambda: board.on == {3})
        switch.close()


def test_the_wrong_language_is_reported(described):
    with on_a_line(LcusBoard()) as port, pytest.raises(SilentSwitchError, match="check .*`kind`"):
        read_switch(described("numato", port)).select("left")


def test_a_pyserial_url_serves_as_well(described):
    """On `loop://` the board hears itself: the echo alone is no answer."""
    with pytest.raises(GarbledSwitchError, match="loop://"):
        read_switch(described("numato", "loop://")).select("left")


def test_relays_above_nine_are_letters(described):
    sent = []

    class Wide(NumatoBoard):
        def take(self, received):
            sent.append(received)
            return super().take(received)

    path = described("numato", "?")
    with on_a_line(Wide()) as port:
        text = path.read_text().replace('"?"', f'"{port}"').replace("[3]", "[3, 12]")
        path.write_text(text)
        with pytest.raises(StuckSwitchError):
            read_switch(path).select("bottom")
    assert b"relay on C\r" in b"".join(sent)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"numato"', '"mux"', "`kind`: .*'numato', 'lcus', 'scpi'"),
        ("settle = 0", "settle = -1", "`settle`: .* greater than or equal to 0, got -1"),
        ("settle = 0", "sttle = 0", "`sttle`: Extra inputs are not permitted"),
        ("timeout = 0.3", "timeout = 0", "`timeout`: .* greater than 0"),
        ("[3]", "[32]", r"`interface`: .*numbers must be in 0..31"),
        ("[3]", "[2, 1]", "`interface`: .*two interfaces have the same relays"),
        ("[3]", '["a"]', "`interface.bottom.0`: .* valid integer"),
        ("left = [1, 2]\nbottom = [3]", "", "`interface`: .* at least 1 item"),
        ("[interface]", "[interface", "is no table of a switch"),
    ],
)
def test_a_table_that_is_wrong_is_one_line_with_the_key(described, old, new, told):
    path = described("numato", "/dev/ttyACM0")
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(InputError, match=told) as raised:
        read_switch(path)
    assert "switch.toml" in str(raised.value) and "\n" not in str(raised.value)


def test_an_interface_that_the_table_lacks_is_bad_input(described):
    switch = read_switch(described("lcus", "/dev/null"))
    with pytest.raises(InputError, match="the switch knows the interfaces left, bottom, got 'top'"):
        switch.select("top")
