"""Live localization with instruments that are no Hioki: right answers, and the meter as found."""

import pytest
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.virtual_models import VIRTUAL_MODELS
from rcskin.tests.hardware.instrument_cases import E4980A, E4990A

pytestmark = pytest.mark.usefixtures("impatient")


@pytest.fixture(params=[E4980A, E4990A], ids=lambda case: case.model)
def case(request):
    """An instrument that is no Hioki."""
    return request.param


@pytest.fixture
def instrument(make_instrument, cushion, case):
    """The virtual instrument at the cushion, as found."""
    return make_instrument(cushion, kind=VIRTUAL_MODELS[case.model], settings=case.found())


def test_presses_are_answered_and_a_lost_line_costs_its_sweep(session, press, instrument, case):
    then = {1: press("1,2"), 2: lambda: instrument.faults.add(Fault("drop")), 3: press("none")}
    live = session(then)
    live.run(4)
    none = "nothing pressed"
    assert live.display.labels == [none, "column 2", "column 2", none]
    assert live.failed == 1
    live.meter.station.release()
    assert instrument.settings == case.found()
