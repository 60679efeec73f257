"""What an object remembers is asked once, is bounded, and goes with the object."""

import gc
import weakref

import pytest
from rcskin.simulator.measure.specimen import Specimen
from rcskin.simulator.method_cache import cached_method
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press

PRESS = "1,1"


class Squares:
    def __init__(self):
        self.asked = []

    @cached_method(2)
    def of(self, number):
        self.asked.append(number)
        return number**2


def test_what_was_asked_is_not_asked_again_until_it_is_the_oldest_of_too_many():
    one, other = Squares(), Squares()
    assert [one.of(k) for k in (1, 2, 1, 2, 3, 2, 1)] == [1, 4, 1, 4, 9, 4, 1]
    assert one.asked == [1, 2, 3, 1]
    assert other.of(1) == 1 and other.asked == [1]


@pytest.fixture
def no_search_for_waste():
    gc.disable()
    yield
    gc.enable()


@pytest.mark.parametrize("model", ["auto", "sheet", "reduced"])
def test_a_solver_and_its_sheets_go_with_the_last_name_for_it(
    make_scene, model, no_search_for_waste
):
    for _ in range(2):  # the first one also imports
        solver = Solver(make_scene(rows=2, columns=2).parts, 1e-3, model)
        solver.solve(parse_press(PRESS, 2.0))
    gone = weakref.ref(solver)
    del solver
    assert gone() is None


def test_a_specimen_goes_and_the_same_at_another_interface_knows_what_it_solved(
    make_scene, no_search_for_waste, monkeypatch
):
    contacts = {"top-left": {}, "bottom-left": {}, "bottom-right": {"resistance": 300.0}}
    pairs = {"one": ("top-left", "bottom-left"), "two": ("top-left", "bottom-right")}
    first = Specimen(make_scene(contacts, pairs).parts, "one")
    second = first.at("two")
    Z = first.impedance(PRESS, 1e3)
    gone = weakref.ref(first)
    del first
    assert gone() is None
    monkeypatch.setattr(Solver, "solve", None)
    assert second.impedance(PRESS, 1e3) != Z
    assert second.at("one").impedance(PRESS, 1e3) == Z
