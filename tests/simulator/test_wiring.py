"""Which foils are one conductor, and which terminals an interface connects."""

import pytest
from pydantic import ValidationError

from simulator.circuit import one_field, two_fields
from simulator.mesh import singular_ends
from simulator.wiring import joined


@pytest.mark.parametrize(
    ("contacts", "expected"),
    [
        ({"top-left": {}, "top-bottom": {}}, [0, 0]),
        ({"top-left": {}, "bottom-bottom": {}}, [0, 1]),
        ({"top-left": {}, "top-right": {}}, [0, 1]),
        ({"top-left": {"span": (0.1, 1.0)}, "top-bottom": {}}, [0, 1]),
        ({"top-left": {"resistance": 1.0}, "top-bottom": {}}, [0, 1]),
        ({"top-left": {"span": (0, 0.5)}, "top-left-2": {"span": (0.5, 1)}}, [0, 0]),
        ({"top-left": {"span": (0, 0.5)}, "top-left-2": {"span": (0.6, 1)}}, [0, 1]),
        ({"top-left": {}, "top-right": {}, "bottom-left": {}, "top-top": {}}, [0, 0, 2, 0]),
    ],
)
def test_ideal_foils_that_touch_are_joined(make_scene, contacts, expected):
    contacts = {**contacts, "bottom-right": {}}
    scene = make_scene(contacts, {"meter": ("top-left", "bottom-right")})
    assert joined(scene.contacts, scene.skin)[:-1] == expected


def test_joined_foils_are_one_terminal_and_floating_ones_their_own(make_scene):
    contacts = {"bottom-left": {}, "top-left": {}, "top-bottom": {}, "bottom-right": {}}
    circuit = two_fields(make_scene(contacts, {"meter": ("top-bottom", "bottom-left")}))
    named = [[contact.name for contact in terminal.contacts] for terminal in circuit.terminals]
    assert named == [["bottom-left"], ["top-left", "top-bottom"], ["bottom-right"]]
    assert [terminal.field for terminal in circuit.terminals] == [1, 0, 1]
    assert (circuit.drives[0].high, circuit.drives[0].low) == ((1,), (0,))


def test_a_sheet_without_foils_gets_a_reference(make_scene):
    circuit = two_fields(make_scene({"top-left": {}, "top-right": {}}))
    assert [(t.field, len(t.contacts)) for t in circuit.terminals] == [(0, 1), (0, 1), (1, 0)]


def test_resistances_of_a_pair_add_up(make_scene):
    pair = {"top-left": {"resistance": 5.0}, "bottom-left": {"resistance": 3.0}}
    circuit = one_field(make_scene(pair, top=50e3, bottom=30e3))
    assert circuit.conductance == (1 / 80e3,)
    assert [c.resistance for t in circuit.terminals for c in t.contacts] == [8.0]


@pytest.mark.parametrize(
    ("contacts", "ends"),
    [
        ({"top-left": {}}, 0),
        ({"top-left": {"span": (0.0, 0.5)}}, 1),
        ({"top-left": {"span": (0.2, 0.7)}}, 2),
        ({"top-left": {}, "top-bottom": {}}, 0),
        ({"top-left": {}, "top-bottom": {"resistance": 1.0}}, 1),
        ({"top-left": {"span": (0, 0.5)}, "top-left-2": {"span": (0.5, 1)}}, 0),
    ],
)
def test_where_the_field_is_singular(make_scene, contacts, ends):
    scene = make_scene({**contacts, "bottom-right": {}}, {"meter": ("top-left", "bottom-right")})
    assert len(singular_ends(scene.contacts, scene.skin)) == ends


@pytest.mark.parametrize("gap", [1e-6, 1e-8])
def test_foils_that_all_but_touch_are_refused(make_scene, gap):
    halves = {"top-left": {"span": (0.0, 0.5)}, "top-left-2": {"span": (0.5 + gap, 1.0)}}
    with pytest.raises(ValidationError, match="must touch, or end at least"):
        make_scene({**halves, "bottom-left": {}}, {"meter": ("top-left", "bottom-left")})
