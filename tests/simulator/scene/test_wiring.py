"""Which foils are one conductor, and which terminals an interface connects.

Foils that are driven because they touch: told by every command that tells of a scene.
"""

import numpy as np
import pytest
from pydantic import ValidationError
from rcskin.simulator.fem.circuit import one_field, two_fields
from rcskin.simulator.mesh.quadrilaterals import singular_ends
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, scene_text
from rcskin.simulator.scene.wiring_checks import conductor_groups


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
    assert conductor_groups(scene.contacts, scene.skin)[:-1] == expected


def test_joined_foils_are_one_terminal_and_floating_ones_their_own(make_scene):
    contacts = {"bottom-left": {}, "top-left": {}, "top-bottom": {}, "bottom-right": {}}
    scene = make_scene(contacts, {"meter": ("top-bottom", "bottom-left")})
    circuit = two_fields(
        scene.parts.skin,
        scene.parts.setup,
    )
    named = [[contact.name for contact in terminal.contacts] for terminal in circuit.terminals]
    assert named == [["bottom-left"], ["top-left", "top-bottom"], ["bottom-right"]]
    assert [terminal.field for terminal in circuit.terminals] == [1, 0, 1]
    assert (circuit.excitations[0].high, circuit.excitations[0].low) == ((1,), (0,))


def test_a_sheet_without_foils_gets_a_reference(make_scene):
    scene = make_scene({"top-left": {}, "top-right": {}})
    circuit = two_fields(
        scene.parts.skin,
        scene.parts.setup,
    )
    assert [(t.field, len(t.contacts)) for t in circuit.terminals] == [(0, 1), (0, 1), (1, 0)]


def test_resistances_of_a_pair_add_up(make_scene):
    pair = {"top-left": {"resistance": 5.0}, "bottom-left": {"resistance": 3.0}}
    scene = make_scene(pair, top=50e3, bottom=30e3)
    circuit = one_field(
        scene.parts.skin,
        scene.parts.setup,
    )
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


PAIRS = {f"{sheet}-{edge}": {} for edge in ("left", "bottom") for sheet in ("top", "bottom")}


@pytest.mark.parametrize(
    ("contacts", "driven", "told"),
    [
        (
            PAIRS,
            ("top-bottom", "bottom-bottom"),
            [
                "contact 'top-left' floats at interface 'meter' but touches 'top-bottom', which is "
                "driven: both are one terminal",
                "contact 'bottom-left' floats at interface 'meter' but touches 'bottom-bottom', "
                "which is driven: both are one terminal",
            ],
        ),
        (
            {"top-left": {}, "top-bottom": {}, "top-right": {}, "bottom-left": {}},
            ("top-left", "bottom-left"),
            [
                "contacts 'top-bottom' and 'top-right' float at interface 'meter' but touch "
                "'top-left', which is driven: all are one terminal"
            ],
        ),
        (
            {"top-left": {}, "top-bottom": {}, "top-right": {}, "bottom-left": {}},
            (("top-left", "top-right"), "bottom-left"),
            [
                "contact 'top-bottom' floats at interface 'meter' but touches 'top-left' and "
                "'top-right', which are driven: all are one terminal"
            ],
        ),
        (PAIRS, (("top-left", "top-bottom"), ("bottom-left", "bottom-bottom")), []),
        ({**PAIRS, "top-left": {"resistance": 1.0}}, ("top-left", "bottom-right"), []),
        ({**PAIRS, "top-left": {"span": (0.1, 1.0)}}, ("top-left", "bottom-right"), []),
        ({"top-left": {}, "top-bottom": {}}, ("bottom-right", "top-right"), []),
    ],
)
def test_a_floating_foil_that_touches_a_driven_one_is_reported(make_scene, contacts, driven, told):
    far = dict.fromkeys({"bottom-right", "top-right"} - contacts.keys(), {"span": (0.4, 1.0)})
    scene = make_scene({**contacts, **far}, {"meter": driven})
    assert [str(found) for found in scene.parts.driven_by_touch] == told


def test_each_interface_has_floating_foils_of_its_own(make_scene):
    meters = {"left": ("top-left", "bottom-left"), "bottom": ("top-bottom", "bottom-bottom")}
    found = [
        (each.interface, each.floating) for each in make_scene(PAIRS, meters).parts.driven_by_touch
    ]
    assert found == [
        ("left", ("top-bottom",)),
        ("left", ("bottom-bottom",)),
        ("bottom", ("top-left",)),
        ("bottom", ("bottom-left",)),
    ]


@pytest.mark.parametrize("between", [{}, {"top-bottom": {}}])
def test_high_and_low_that_touch_are_refused(make_scene, between):
    """At a corner, or by way of a foil that floats."""
    edges = ("left", "right") if between else ("left", "bottom")
    ends = {f"top-{edge}": {} for edge in edges}
    with pytest.raises(ValidationError, match="interface 'meter' shorts its high and low side"):
        make_scene({**ends, **between}, {"meter": tuple(ends)})


def test_reported_terminals_are_those_that_are_solved(make_scene):
    """Driven by touch or by name: the same impedance, and another one where a gap parts them."""

    def Z(high, span=(0.0, 1.0)):
        contacts = {"top-left": {}, "bottom-right": {}, "top-bottom": {"span": span}}
        return (
            Solver(make_scene(contacts, {"meter": (high, "bottom-right")}).parts).solve(Press()).Z
        )

    touching = Z("top-left")
    np.testing.assert_array_equal(touching, Z(("top-left", "top-bottom")))
    assert np.abs(Z("top-left", (0.1, 1.0)) / touching - 1).max() > 0.01


@pytest.mark.parametrize("name", builtin_names())
def test_no_foil_of_a_built_in_scene_is_driven_by_touch(name):
    assert load_scene(name).parts.driven_by_touch == []


TOLD = (
    "contact 'top-left' floats at interface 'bottom' but touches 'top-bottom', which is driven: "
    "both are one terminal"
)


@pytest.fixture
def scene_file(make_scene, tmp_path):
    """A file with a scene of two interfaces whose top sheet's foils meet at a corner."""
    contacts = {"top-left": {}, "top-bottom": {}, "bottom-right": {"span": (0.2, 0.8)}}
    interfaces = {"bottom": ("top-bottom", "bottom-right"), "left": ("top-left", "bottom-right")}
    scene = make_scene(contacts, interfaces, columns=2, frequencies=[1e3])
    path = tmp_path / "mine.toml"
    path.write_text(scene_text(scene))
    return path


def test_a_sweep_warns_and_explains(run, scene_file, tmp_path):
    code, out, err = run(
        "sweep", scene_file, "--press", "none", "--explain", "-o", tmp_path / "out.csv"
    )
    assert code == 0
    first, second = err.splitlines()
    assert first == f"rcskin: warning: {scene_file}: {TOLD}"
    assert second.startswith(f"rcskin: warning: {scene_file}: contact 'top-bottom' floats at inter")
    assert out.splitlines()[0] == f"wiring: {TOLD}"


def test_a_view_warns_of_its_own_interface(run, scene_file, tmp_path):
    code, _, err = run(
        "view", scene_file, "--interface", "bottom", "--rtol", "1e-2", "-o", tmp_path / "out.vtu"
    )
    assert (code, err) == (0, f"rcskin: warning: {scene_file}: {TOLD}\n")


@pytest.mark.usefixtures("short_studies")
def test_a_study_warns_once(run, scene_file, tmp_path):
    text = scene_file.read_text()
    for noise in ("magnitude_noise", "phase_noise"):
        text = text.replace(f"{noise} = 0.0", f"{noise} = 3e-3")
    scene_file.write_text(text)
    code, _, err = run(
        *("study", scene_file, "--vary", "skin.width=0.08:0.1:2", "--draws", "1"),
        *("--workers", "1", "--rtol", "1e-2", "-o", tmp_path / "out.csv"),
    )
    assert (code, err) == (
        0,
        f"rcskin: warning: {scene_file}: 2 of 2 points, the first: {TOLD}\n",
    )


def test_a_gap_between_the_foils_ends_the_warning(run, scene_file, tmp_path):
    text = scene_file.read_text()
    apart = text.replace("    0.0,\n    1.0,\n", "    0.01,\n    1.0,\n", 1)
    assert apart != text
    scene_file.write_text(apart)
    code, _, err = run("sweep", scene_file, "--press", "none", "-o", tmp_path / "out.csv")
    assert (code, err) == (0, "")


def test_high_against_low_at_a_corner_stays_an_error(refused, scene_file, tmp_path):
    text = scene_file.read_text().replace('"bottom-right",\n', '"top-left",\n', 1)
    scene_file.write_text(text)
    assert (
        refused("sweep", scene_file, "-o", tmp_path / "out.csv")
        == f"rcskin: {scene_file}: interface 'bottom' shorts its high and low side\n"
    )
