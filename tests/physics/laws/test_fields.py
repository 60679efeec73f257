"""Fields of a press: what they add up to, and sensitivities against presses that are solved.

The problem is its own adjoint: one solution tells what every small change would do.
"""

from dataclasses import replace

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.meter import Leads

CROSSED = {"top-left": {}, "bottom-bottom": {}}
MORE = {"rows": 3, "columns": 3, "frequencies": [1e3, 3e4]}
L_SHAPE = [[0, 0], [0.1, 0], [0.1, 0.04], [0.05, 0.04], [0.05, 0.08], [0, 0.08]]
LEADS = {"resistance": 2e4, "inductance": 1e-2, "stray_capacitance": 2e-12}
NEXT = ("1,2:3+2,1:0.95", "1,2:3+2,1:1.05")
SKINS = {
    "plain": {},
    "anisotropic": {"top.anisotropy": {"ratio": 5.0, "angle": 0.5}, "bottom.piezoresistance": 1.0},
    "mapped": {
        "top.map": {"kind": "gradient", "x": 0.7, "y": -0.3},
        "foam.map": {"kind": "random", "deviation": 0.2, "correlation_length": 0.04, "seed": 3},
    },
    "an L": {"outline.points": L_SHAPE},
    "a sphere": {"shape": {"kind": "sphere", "radius": 0.06}},
}


@pytest.fixture(scope="module")
def skin(varied):
    """A function of a name of SKINS to a scene fed from two edges."""

    def skin(name, **more):
        edges = {"top-outline.6": {}, "bottom-outline.1": {}} if name == "an L" else CROSSED
        return varied(SKINS[name], edges, **MORE, **more)

    return skin


def weights(found):
    """m² of every point: a third or a quarter of the parts around it."""
    x = found.x[:, found.cells]
    area = np.zeros(found.cells.shape[1])
    for k in range(1, len(found.cells) - 1):
        u, v = x[:, k] - x[:, 0], x[:, k + 1] - x[:, 0]
        area += abs(u[0] * v[1] - u[1] * v[0]) / 2
    total = np.zeros(found.x.shape[1])
    for corner in found.cells:
        np.add.at(total, corner, area / len(found.cells))
    return total


@pytest.mark.parametrize("name", SKINS)
def test_Z_is_that_of_the_solver(skin, off, name):
    scene, press = skin(name), parse_press("1,2:3", 2.0)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        press, scene.frequencies, "meter", 1e-3
    )
    assert off(found.Z, Solver(scene.parts, 1e-4).solve(press).Z[0]).max() < 1.1e-3


@pytest.mark.parametrize("name", SKINS)
def test_power_adds_up_to_what_the_meter_puts_in(skin, name):
    """Re(Y) / 2 at 1 V of amplitude: ideal foils and foam lose nothing."""
    scene = skin(name)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("1,2:3", 2.0), scene.frequencies, "meter", 1e-3
    )
    put_in = (1 / found.Z).real / 2
    np.testing.assert_allclose(found.power @ weights(found), put_in, rtol=2e-2)
    assert (found.power >= -1e-12 * found.power.max()).all()


@pytest.mark.parametrize("name", SKINS)
def test_charge_of_the_foam_is_the_current_of_the_meter(skin, name):
    """s c (V_t - V_b) over the skin is I = Y; s c (V_t - V_b)² is Y less the heat in the sheets."""
    scene = skin(name)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("1,2:3", 2.0), scene.frequencies, "meter", 1e-3
    )
    s = 2j * np.pi * found.frequency
    across = found.potential[0] - found.potential[1]
    np.testing.assert_allclose(
        s * ((found.capacitance * across) @ weights(found)), 1 / found.Z, rtol=3e-3
    )


@pytest.mark.parametrize("name", ["plain", "anisotropic", "an L"])
def test_change_by_a_rise_of_capacitance_is_that_of_a_small_press(skin, name):
    """Central differences of 5 % more and less on single pixels, one of them pressed already."""
    scene = without_gauge(skin(name))
    behind = scene.model_copy(update={"leads": Leads(**LEADS)})
    press, f = parse_press("1,2:3", 2.0), scene.frequencies
    found = [
        (each, Elements(each.parts.skin, each.parts.setup).fields(press, f, "meter", 1e-4))
        for each in (scene, behind)
    ]
    solver = Solver(scene.parts, 1e-5)
    for pixel, pressed in (((1, 2), ("1,2:2.85", "1,2:3.15")), ((2, 1), NEXT)):
        Z = [solver.solve(parse_press(text, 2.0)).Z[0] for text in pressed]
        for each, of_press in found:
            seen = [each.leads.at_meter(at_skin, f) for at_skin in Z]
            less, more = (np.log([at.real, (1 / at).imag]) for at in seen)
            change = (more - less) / 0.1
            told = total_over_pixel(each, of_press, *pixel)
            np.testing.assert_allclose(told, change, rtol=0, atol=1e-2 * abs(change).max())


def without_gauge(scene):
    """The scene with sheets whose resistance a press leaves alone."""
    bottom = scene.skin.bottom.model_copy(update={"piezoresistance": 0.0})
    return scene.model_copy(update={"skin": scene.skin.model_copy(update={"bottom": bottom})})


def total_over_pixel(scene, found, row, column):
    """Of what rises of capacitance change, for double that of a pixel, shape (2, frequency)."""
    middle = found.x[:, found.cells].mean(axis=1)
    rows, columns = scene.pixels.shape
    i, j = middle[1] // (scene.skin.width / rows), middle[0] // (scene.skin.length / columns)
    there = (i == row - 1) & (j == column - 1)
    x = found.x[:, found.cells[:, there]]
    area = 0.0
    for k in range(1, len(found.cells) - 1):
        u, v = x[:, k] - x[:, 0], x[:, k + 1] - x[:, 0]
        area = area + abs(u[0] * v[1] - u[1] * v[0]) / 2
    changes = (found.by_rise_Rs, found.by_rise_Cp)
    return np.stack([each[:, found.cells[:, there]].mean(axis=1) @ area for each in changes])


@pytest.mark.parametrize("name", ["plain", "anisotropic", "an L"])
def test_current_through_a_cut_is_what_charges_beyond_it(skin, name):
    """Upwards in the bottom sheet, fed along y = 0: s c (V_t - V_b) over what lies above."""
    scene = skin(name)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        Press(), scene.frequencies, "meter", 1e-4
    )
    mean, s = weights(found), 2j * np.pi * found.frequency
    low, high = 0.02, 0.03
    strip = (found.x[1] > low) & (found.x[1] < high)
    height = mean[strip].sum() / scene.skin.length
    through = found.current[1, :, 1][:, strip] @ mean[strip] / height
    density = s[:, None] * found.capacitance * (found.potential[0] - found.potential[1])
    middle = np.average(found.x[1, strip], weights=mean[strip])
    beyond = density @ np.where(found.x[1] > middle, mean, 0.0)
    np.testing.assert_allclose(through, -beyond, rtol=4e-2)


def test_one_field_gives_the_potentials_of_two(varied):
    """Foils in pairs are one field; a bottom sheet of another map, alike within 1e-9, is two."""
    pair = {"top-left": {"span": (0.2, 0.8)}, "bottom-left": {"span": (0.2, 0.8)}}
    same = {"kind": "gradient", "x": 0.5}
    other = {"kind": "gradient", "x": 0.5, "y": 1e-9}
    found = []
    for bottom in (same, other):
        scene = varied({"top.map": same, "bottom.map": bottom}, pair, **MORE)
        found.append(
            Elements(scene.parts.skin, scene.parts.setup).fields(
                parse_press("2,3:3", 2.0), scene.frequencies, "meter", 1e-3
            )
        )
    one, two = found
    np.testing.assert_allclose(one.Z, two.Z, rtol=1e-3)
    mean = weights(one), weights(two)
    for name in ("potential", "current"):
        a, b = (getattr(each, name) for each in found)
        a = a - a[..., :1] * (name == "potential")
        b = b - b[..., :1] * (name == "potential")
        np.testing.assert_allclose(a @ mean[0], b @ mean[1], atol=2e-2 * abs(a @ mean[0]).max())
    power = [each.power @ own for each, own in zip(found, mean, strict=True)]
    np.testing.assert_allclose(*power, rtol=2e-3)


def test_places_on_a_cylinder_keep_their_distances(varied):
    """Bent around x = 50 mm: places lie on the cylinder, currents as on the flat skin."""
    radius = 0.04
    flat = varied({}, CROSSED, **MORE)
    bent = varied({"shape": {"kind": "cylinder", "radius": radius}}, CROSSED, **MORE)
    one, other = (
        Elements(each.parts.skin, each.parts.setup).fields(Press(), [1e3], "meter", 1e-3)
        for each in (flat, bent)
    )
    np.testing.assert_array_equal(one.current, other.current)
    x, y, z = other.position
    np.testing.assert_allclose((x - 0.05) ** 2 + (z + radius) ** 2, radius**2, rtol=1e-9)
    np.testing.assert_allclose(
        np.arctan2(x - 0.05, z + radius) * radius, one.x[0] - 0.05, atol=1e-12
    )
    np.testing.assert_array_equal(y, one.x[1])
    assert (one.position[2] == 0).all()


def test_places_on_a_sphere_lie_on_it(skin):
    scene = skin("a sphere")
    found = Elements(scene.parts.skin, scene.parts.setup).fields(Press(), [1e3], "meter", 1e-2)
    x, y, z = found.position
    np.testing.assert_allclose(
        (x - 0.05) ** 2 + (y - 0.04) ** 2 + (z + 0.06) ** 2, 0.06**2, rtol=1e-9
    )


def test_factors_of_a_pressed_polygon(varied):
    """The factor is there within the polygon and nowhere else."""
    scene = varied({}, CROSSED, **MORE)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("poly(0.02,0.02,0.06,0.03,0.03,0.06):4", 2.0), [1e3], "meter"
    )
    area = (0.04 * 0.04 - 0.01 * 0.01) / 2
    mean = weights(found)
    assert set(np.unique(found.factor)) == {1.0, 4.0}
    assert mean[found.factor == 4].sum() == pytest.approx(area, rel=1e-9)
    np.testing.assert_allclose(found.capacitance, 5e-9 * found.factor, rtol=1e-12)


def test_foam_without_tension_deflects_under_the_touch_alone(varied):
    foam = {"thickness": 4e-3, "relative_permittivity": 2.0, "mechanics": {"modulus": 6e4}}
    scene = varied({"foam": foam}, CROSSED, **MORE)
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("rect(0.02,0.02,0.03,0.02):1mm", 2.0), [1e3], "meter"
    )
    assert set(np.round(np.unique(found.deflection), 9)) == {0.0, 1e-3}
    pressed = weights(found)[found.deflection > 0].sum()
    assert pressed == pytest.approx(0.03 * 0.02, rel=1e-9)


def leaning(path, turn, length=0.1, width=0.04, n=6):
    """A mesh of a strip that leans by `turn` about its left edge, in the group `part=1`."""
    u, v = (each.ravel() for each in np.meshgrid(np.linspace(0, length, n), [0, width / 2, width]))
    points = np.stack([u * np.cos(turn), v, u * np.sin(turn)], axis=1)
    own = np.array([[0, 1, n], [1, n + 1, n]])
    starts = [row * n + column for row in range(2) for column in range(n - 1)]
    triangles = np.concatenate([own + start for start in starts])
    foil = np.array([[0, n], [n, 2 * n]])
    cells = [("triangle", triangles), ("line", foil)]
    part = [np.zeros(len(triangles), dtype=int), np.ones(len(foil), dtype=int)]
    meshio.write(path, meshio.Mesh(points, cells, cell_data={"part": part}))
    return str(path)


def test_a_leaning_strip_has_the_fields_of_a_lying_one(varied, tmp_path):
    """Seen from above: its currents are as much shorter along x as it is."""
    turn, edges = 0.7, {"top-part=1": {}, "bottom-part=1": {}}
    found = []
    for name, angle in (("lying", 0.0), ("leaning", turn)):
        skin = {"mesh": leaning(tmp_path / f"{name}.vtu", angle)}
        size = {"length": 0.1 * np.cos(angle), "width": 0.04}
        scene = varied(skin, edges, **size, frequencies=[1e3, 3e4])
        found.append(
            Elements(scene.parts.skin, scene.parts.setup).fields(
                Press(), scene.frequencies, "meter", 1e-3
            )
        )
    lying, other = found
    np.testing.assert_allclose(other.Z, lying.Z, rtol=1e-9)
    np.testing.assert_allclose(other.potential, lying.potential, atol=1e-9)
    np.testing.assert_allclose(other.position[2], np.tan(turn) * other.x[0], atol=1e-12)
    np.testing.assert_allclose(other.position[:2], other.x, atol=1e-12)
    most = np.abs(lying.current).max()
    shorter = lying.current * np.array([np.cos(turn), 1.0])[:, None]
    np.testing.assert_allclose(other.current, shorter, atol=1e-9 * most)


ORDER = Resolution(order=3)


def derivative(function, step):
    """d function / dx at 0 by differences of fourth order."""
    near, far = ((function(k * step) - function(-k * step)) / (2 * k * step) for k in (1, 2))
    return (4 * near - far) / 3


def strengthened(press, touch, by):
    """The press with one touch's factor raised."""
    return Press(tuple(replace(t, factor=t.factor + by * (t == touch)) for t in press.touches))


@given(data=st.data(), at=st.sampled_from([0.1, 1.0, 30.0]))
def test_admittance_to_capacitance(random, frequency_at, plain_skin, data, at):
    """dY = s * integral of dc (v/V0)², v = V_t - V_b, without a conjugate."""
    scene = data.draw(random.between())
    touch = Touch(
        data.draw(st.integers(1, scene.pixels.rows)),
        data.draw(st.integers(1, scene.pixels.columns)),
        data.draw(st.floats(0.5, 5)),
    )
    press, frequency = Press((touch,)), frequency_at(scene, at)
    sheet = SheetModel(scene.parts.skin, two_fields(scene.parts.skin, scene.parts.setup), ORDER)
    dc = capacitance_map(scene.parts.skin, strengthened(press, touch, 1.0)) - capacitance_map(
        scene.parts.skin, press
    )
    plain = plain_skin(scene, ORDER)
    u, _ = plain.solve(press, frequency.item())
    predicted = laplace_variable(frequency.item()) * (u @ plain.mass(dc) @ u)

    def Y(by):
        return 1 / sheet.impedance(strengthened(press, touch, by), frequency)[0]

    assert abs(derivative(Y, 2e-3) - predicted) < 1e-8 * abs(Y(0.0))


@settings(max_examples=10)
@given(data=st.data(), at=st.sampled_from([0.1, 1.0, 30.0]))
def test_impedance_to_sheet_resistance(random, frequency_at, plain_skin, data, at):
    """dZ = integral of dR J.J / I², J = grad V / R, without a conjugate."""
    scene = data.draw(random.between())
    press, frequency = data.draw(random.presses(scene)), frequency_at(scene, at)
    plain, skin = plain_skin(scene, ORDER), scene.skin
    u, current = plain.solve(press, frequency.item())
    predicted = u @ plain.sheets[0] @ u / skin.top.sheet_resistance / current**2

    def Z(by):
        top = skin.top.model_copy(update={"sheet_resistance": (1 + by) * skin.top.sheet_resistance})
        resistant = scene.model_copy(update={"skin": skin.model_copy(update={"top": top})})
        return SheetModel(
            resistant.parts.skin,
            two_fields(resistant.parts.skin, resistant.parts.setup),
            ORDER,
        ).impedance(press, frequency)[0]

    assert abs(derivative(Z, 2e-3) - predicted) < 1e-8 * abs(Z(0.0))
