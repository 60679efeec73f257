"""Gains of nodes behind series resistors against closed forms, and their slopes and errors."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.scene.parts import Setup

FREQUENCIES = (1e2, 1e3, 1e4)
R = 1e6
LOAD = {"resistance": 5e6, "capacitance": 8e-12}
LEADS = Leads(resistance=2e3, inductance=0.1, stray_capacitance=30e-12)
YARN = {"top-left": {}, "top-right": {}, "bottom-left": {}}


def reading(scene, **keys):
    """The scene with a reader of gains at all interfaces."""
    more = {"reader": "gain", "series_resistance": R, **keys}
    each = range(1, len(scene.interfaces) + 1)
    return scene.with_({f"interface.{k}.{key}": own for k in each for key, own in more.items()})


def at_both_ends(make_scene, **more):
    """A resistive strip over a conductor, driven and read at both ends."""
    each = {"left": ("top-left", "bottom-left"), "right": ("top-right", "bottom-left")}
    scene = reading(
        make_scene(YARN, each, bottom=1e-4, columns=4, frequencies=FREQUENCIES, **more), load=LOAD
    )
    return scene.with_(
        {"interface.left.driven_with": ["right"], "interface.right.driven_with": ["left"]}
    )


def closed(Z, frequency, load=LOAD):
    """V / V_s of a node with Z to low behind R."""
    below = 1 / Z + 1 / load["resistance"] + 2j * np.pi * frequency * load["capacitance"]
    return 1 / (1 + R * below)


def coth(R, C, frequency):
    """An open line of R in ohm and C in F."""
    q = np.sqrt(2j * np.pi * frequency * R * C)
    return R / np.tanh(q) / q


def line_of(scene):
    skin = scene.skin
    square = skin.length / skin.width
    C = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width
    return skin.top.sheet_resistance * square, skin.bottom.sheet_resistance * square, C


def test_a_line_behind_a_resistor(make_scene):
    scene = reading(make_scene(frequencies=FREQUENCIES), load=LOAD)
    top, bottom, C = line_of(scene)
    expected = closed(coth(top + bottom, C, scene.frequencies), scene.frequencies)
    np.testing.assert_allclose(Solver(scene.parts).solve(Press()).Z[0], expected, rtol=1e-11)


def test_leads_lie_between_the_node_and_the_skin(make_scene):
    scene = reading(make_scene(frequencies=FREQUENCIES), load=LOAD)
    led = scene.model_copy(update={"leads": LEADS})
    top, bottom, C = line_of(scene)
    behind = LEADS.at_meter(coth(top + bottom, C, scene.frequencies), scene.frequencies)
    expected = closed(behind, scene.frequencies)
    np.testing.assert_allclose(Solver(led.parts).solve(Press()).Z[0], expected, rtol=1e-11)


def test_a_skin_at_low_frequency_is_one_r_and_one_c_behind_the_resistor(make_scene):
    scene = reading(make_scene({"top-left": {}, "bottom-bottom": {}}, frequencies=(1e-2, 1e-1)))
    _, _, C = line_of(scene)
    expected = 1 / (1 + 2j * np.pi * scene.frequencies * R * C)
    np.testing.assert_allclose(Solver(scene.parts).solve(Press()).Z[0], expected, rtol=1e-5)


def test_a_load_of_large_resistance_is_no_load(make_scene):
    scene = make_scene(frequencies=FREQUENCIES)
    open_input, large = reading(scene), reading(scene, load={"resistance": 1e15})
    one, other = (Solver(each.parts).solve(Press()).Z for each in (open_input, large))
    np.testing.assert_allclose(one, other, rtol=1e-8)


def test_two_symmetric_driven_ends_are_one_end_of_half_the_line(make_scene):
    scene = at_both_ends(make_scene)
    top, _, C = line_of(scene)
    expected = closed(coth(top / 2, C / 2, scene.frequencies), scene.frequencies)
    answer = Solver(scene.parts).solve(Press())
    for each in answer.Z:
        np.testing.assert_allclose(each, expected, rtol=2e-5)


def test_a_press_at_one_end_is_the_mirror_of_that_at_the_other(make_scene):
    solver = Solver(at_both_ends(make_scene).parts)
    one, other = (solver.solve(parse_press(f"1,{k}", 3.0)).Z for k in (1, 4))
    np.testing.assert_allclose(one, other[::-1], rtol=1e-5)
    assert (np.abs(one / other - 1) > 1e-4).any()


def test_the_far_source_is_seen_as_by_superposition(make_scene):
    """The impedance matrix of both ends follows from impedances with the other end free as well:
    Z_ab = (Z_aa + Z_bb - Z between the ends) / 2."""
    scene = at_both_ends(make_scene)
    press = parse_press("1,1", 3.0)
    free = make_scene(
        YARN,
        {
            "left": ("top-left", "bottom-left"),
            "right": ("top-right", "bottom-left"),
            "between": ("top-left", "top-right"),
        },
        bottom=1e-4,
        columns=4,
        frequencies=FREQUENCIES,
    )
    a, b, between = Solver(free.parts, 1e-7).solve(press).Z
    mutual = (a + b - between) / 2
    Z = np.moveaxis(np.array([[a, mutual], [mutual, b]]), -1, 0)
    inputs = 1 / R + 1 / LOAD["resistance"] + 2j * np.pi * scene.frequencies * LOAD["capacitance"]
    nodes = np.linalg.inv(Z) + inputs[:, None, None] * np.eye(2)
    V = np.linalg.solve(nodes, np.full((len(inputs), 2, 1), 1 / R))[..., 0].T
    np.testing.assert_allclose(Solver(scene.parts, 1e-7).solve(press).Z, V, rtol=1e-6)


@pytest.mark.parametrize("together", [False, True])
def test_slopes_are_those_of_differences(make_scene, together):
    interfaces = at_both_ends(make_scene).interfaces
    if not together:
        interfaces = [each.model_copy(update={"driven_with": ()}) for each in interfaces]
    setup = Setup(interfaces, np.array(FREQUENCIES), LEADS)
    random = np.random.default_rng(1)
    shape = (2, len(setup.solved), len(FREQUENCIES))
    Z = 1e6 * (random.uniform(0.1, 1, shape) - 1j * random.uniform(0.1, 1, shape))
    slopes, step = setup.slopes(Z), 1e-5
    change = Z * (random.standard_normal(shape) + 1j * random.standard_normal(shape))
    found = (setup.at_meter(Z + step * change) - setup.at_meter(Z - step * change)) / (2 * step)
    np.testing.assert_allclose(slopes.of(change), found, rtol=1e-7)
    np.testing.assert_allclose(slopes.of_many(change[..., None])[..., 0], found, rtol=1e-7)
    for key, name in (
        ("resistance", "lead_resistance"),
        ("inductance", "lead_inductance"),
        ("stray_capacitance", "stray_capacitance"),
    ):
        own = getattr(LEADS, key)
        ends = [LEADS.model_copy(update={key: own * (1 + sign * step)}) for sign in (1, -1)]
        above, below = (setup.behind(leads).at_meter(Z) for leads in ends)
        found = (above - below) / (2 * step * own)
        np.testing.assert_allclose(slopes.by_leads[name], found, rtol=1e-5)


@pytest.mark.parametrize("rtol", [1e-3, 1e-4])
def test_the_estimated_error_covers_that_against_a_tighter_solve(make_scene, rtol):
    scene = at_both_ends(make_scene).model_copy(update={"leads": LEADS})
    press = parse_press("1,2", 2.0)
    answer, truth = (Solver(scene.parts, each).solve(press) for each in (rtol, 1e-8))
    (estimated,) = answer.relative_errors
    assert (np.abs(answer.Z / truth.Z - 1) <= estimated).all()
    assert (estimated <= rtol).all()


def test_a_body_at_earth_loads_the_node_although_a_virtual_earth_would_not_read_it(make_scene):
    """The current of a node into earth passes the series resistor: |G| falls."""
    scene = make_scene(frequencies=FREQUENCIES)
    near = scene.with_({"surroundings": {"body": {"side": "top", "distance": 1e-3}}})
    alone, loaded = (
        np.abs(Solver(reading(each).parts).solve(Press()).Z[0]) for each in (scene, near)
    )
    assert (loaded < alone).all()
    C = line_of(scene)[2] + 8.8541878128e-12 / 1e-3 * scene.skin.length * scene.skin.width
    slow = reading(near).with_({"sweep.frequencies": [1e-1]})
    expected = 1 / (1 + 2j * np.pi * 1e-1 * R * C)
    np.testing.assert_allclose(Solver(slow.parts).solve(Press()).Z[0, 0], expected, rtol=1e-5)
