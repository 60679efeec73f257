"""Live localization with instruments that are no Hioki: right answers, and the meter as found."""

import socket

import pytest
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.tests.hardware.instrument_cases import E4980A, E4990A, IM3523

pytestmark = pytest.mark.usefixtures("impatient")


@pytest.fixture(params=[E4980A, E4990A], ids=lambda case: case.model)
def case(request):
    """An instrument."""
    return request.param


@pytest.fixture
def instrument(make_instrument, cushion, case):
    """The virtual instrument at the cushion, as found."""
    return make_instrument(cushion, kind=VIRTUAL_MODELS[case.model], settings=case.found())


@pytest.fixture
def other_client(ports):
    """A function that has another client send a line."""

    def send(line):
        with socket.create_connection(("127.0.0.1", ports.meter), timeout=5) as client:
            client.sendall(f"{line}\n*IDN?\n".encode())
            client.recv(100)

    return send


def test_presses_are_answered_and_a_lost_line_costs_its_sweep(session, press, instrument, case):
    then = {1: press("1,2"), 2: lambda: instrument.faults.add(Fault("drop")), 3: press("none")}
    live = session(then)
    live.run(4)
    none = "nothing pressed"
    assert live.display.labels == [none, "column 2", "column 2", none]
    assert live.failed == 1
    live.meter.station.release()
    assert instrument.settings == case.found()


QUANTITIES = [
    pytest.param(case, line, id=f"{case.model}-{line}")
    for case in (IM3523, E4980A, E4990A)
    for line in case.quantities
    if line != ":FREQuency 2E3"  # which is set before each reading
]


@pytest.mark.parametrize(("case", "line"), QUANTITIES, indirect=["case"])
def test_no_answer_is_shown_from_quantities_that_another_client_changed(
    session, press, instrument, case, line, other_client
):
    none = "nothing pressed"
    live = session({1: press("1,2"), 2: lambda: other_client(line), 3: press("none")})
    live.run(4)
    assert live.display.labels == [none, "column 2", "column 2", none]
    assert live.failed == 1 and "check" in live.display.told[-1]
    live.meter.station.release()
    assert instrument.settings == case.found()
