"""Fingers, the rim and the depth of the foam, each against a closed form."""

import math

import meshio
import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.sweeps import InputError, parallel_capacitance

LOW = 1e-2
"""Hz."""


def finger_law(scene, farads, start, stop):
    """Change of Rs as f -> 0 by a finger across the whole width between two places, ohm.

    R C_f c (L x - x²/2) / C², its mean over the patch; R and c per length, C of the whole skin.
    """
    skin = scene.skin
    L, c = skin.length, scene.skin.foam.unpressed_capacitance_per_area * skin.width
    mean = (L * (stop**2 - start**2) / 2 - (stop**3 - start**3) / 6) / (stop - start)
    return skin.top.sheet_resistance / skin.width * farads * c * mean / (c * L) ** 2


@pytest.mark.parametrize(("start", "stop"), [(0.0, 0.02), (0.04, 0.06), (0.08, 0.1)])
def test_low_frequency_law_of_a_finger(around, solve, start, stop):
    scene = around({}, frequencies=[LOW], columns=5)
    press = f"rect({(start + stop) / 2},0.04,0.02,0.08):1.0:5.3pF"
    change = solve(scene, press, 1e-7).Z.real - solve(scene, "none", 1e-7).Z.real
    assert change.item() == pytest.approx(finger_law(scene, 5.3e-12, start, stop), rel=1e-5)


def test_a_finger_is_a_body_where_it_touches_all(around, solve):
    scene = around({}, columns=2)
    finger = solve(scene, "rect(0.05,0.04,0.1,0.08):1.0:8pF", 1e-5)
    body = around({"body": {"side": "top", "capacitance_per_area": 8e-12 / 0.008}}, columns=2)
    assert relative_difference(finger.Z, solve(body, rtol=1e-5).Z).max() <= 2e-5


def test_a_finger_touches_the_sheet_that_its_cover_is_on(around, solve):
    """Sheets of one resistance change places with the sides that fingers touch."""
    below = {"side": "bottom", "thickness": 1e-3, "relative_permittivity": 3.0}
    sheets = {"top": 40e3, "bottom": 40e3, "columns": 3}
    there, back = (
        solve(around(given, **sheets), "1,2:1.5:4pF", 1e-5) for given in ({}, {"cover": below})
    )
    assert relative_difference(there.Z, back.Z).max() <= 2e-5


def test_a_hover_a_press_and_both(around, solve):
    """Factor and finger of one touch are those of two touches of the same place."""
    scene = around({"body": {"distance": 5e-3}}, rows=2, columns=3)
    one = solve(scene, "2,2:1.8:3pF", 1e-5)
    place = "rect(0.05,0.06,0.0333333333333333,0.04)"
    two = solve(scene, f"2,2:1.8:rod+{place}:1.0:3pF", 1e-5)
    assert relative_difference(one.Z, two.Z).max() <= 3e-5
    assert relative_difference(one.Z, solve(scene, "2,2:1.8:rod", 1e-5).Z).max() > 1e-2


def test_field_across_the_foam_is_not_straight(around, solve, three_conductors):
    """G + s eps d [[1/3, 1/6], [1/6, 1/3]] in place of G in the line; 1 % of Rs at 10 MHz."""
    given = {"thickness": True, "body": {"capacitance_per_area": 1.77e-9}}
    scene = around(given, {"thickness": 4e-3}, frequencies=np.geomspace(1e3, 1e7, 6).tolist())
    along = 5e-9 * 4e-3**2
    exact = -1 / three_conductors(scene, 0.0, 1.77e-9, along)[:, 0, 1]
    without = -1 / three_conductors(scene, 0.0, 1.77e-9)[:, 0, 1]
    answer = solve(scene)
    assert relative_difference(answer.Z[0], exact).max() <= 1e-6
    assert relative_difference(answer.Z[0], without).max() > 1e-3


def test_a_factor_divides_the_depth_of_the_foam(around, solve):
    """A skin pressed all over by k is one of foam with k times c and a k-th of the thickness."""
    given = {"thickness": True, "body": {"capacitance_per_area": 1.77e-9}}
    high = {"frequencies": [1e6, 1e7]}
    unpressed = around(given, {"thickness": 4e-3}, **high)
    pressed = solve(unpressed, "1,1:2.0:rod").Z
    thinner = around(given, {"thickness": 2e-3}, c=1e-8, **high)
    assert relative_difference(pressed, solve(thinner).Z).max() <= 2e-6
    as_thick = around(given, {"thickness": 4e-3}, c=1e-8, **high)
    assert relative_difference(pressed, solve(as_thick).Z).max() > 1e-3


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_factor_thins_the_foam(around, solve, three_conductors, factor):
    """A skin pressed all over is one of thinner foam of the same permittivity."""
    pressed = around({"thickness": True}, {"thickness": 4e-3}, frequencies=[1e6, 1e7])
    thin = {"thickness": 4e-3 / factor}
    thinner = around({"thickness": True}, thin, c=factor * 5e-9, frequencies=[1e6, 1e7])
    off = relative_difference(
        solve(pressed, f"rect(0.05,0.04,0.1,0.08):{factor}:rod").Z, solve(thinner).Z
    )
    assert off.max() <= 2e-6


def test_a_law_for_equal_sheets(around, solve):
    """Sheets of one resistance: c v² + c d²/12 |grad v|², so R rises by s R c d²/12 as a part."""
    scene = around({"thickness": True}, {"thickness": 4e-3}, top=4e4, bottom=4e4, frequencies=[1e7])
    s = 2j * np.pi * 1e7
    R = 8e4 / (1 + s * 5e-9 * 4e-3**2 / 12 * 8e4)
    q = np.sqrt(s * R * 5e-9) * 0.1
    exact = R * 0.1 / 0.08 / q / np.tanh(q)
    assert relative_difference(solve(scene).Z[0], np.array([exact])).max() <= 1e-6


RIM = {"mutual": 8e-12, "top": 2e-11, "bottom": 5e-12}


@pytest.mark.parametrize("low", ["virtual earth", "floating"])
def test_capacitance_of_the_rim(around, solve, low):
    """Cp(0) = c A + the perimeter's; where the meter floats, those to earth in series, too."""
    scene = around({"low": low, "rim": RIM}, frequencies=[LOW])
    perimeter, A = 0.36, 0.008
    series = RIM["top"] * RIM["bottom"] / (RIM["top"] + RIM["bottom"])
    per_length = RIM["mutual"] + series * (low == "floating")
    Cp = parallel_capacitance(solve(scene).Z, scene.frequencies).item()
    assert Cp == pytest.approx(5e-9 * A + per_length * perimeter, rel=1e-9)


def test_rim_of_a_narrow_line(around, solve):
    """Along both sides as foam, and at the ends as lumped capacitances."""
    sizes = {"length": 0.1, "width": 1e-3, "frequencies": [1e3, 1e4, 1e5]}
    scene = around({"rim": 2e-12}, **sizes)
    s, c, R = 2j * np.pi * scene.frequencies, 5e-9 * 1e-3 + 2 * 2e-12, 80e3 / 1e-3
    q, Y0, end = np.sqrt(s * R * c) * 0.1, np.sqrt(s * c / R), s * 2e-12 * 1e-3
    Y = Y0 * (end + Y0 * np.tanh(q)) / (Y0 + end * np.tanh(q)) + end
    assert relative_difference(solve(scene).Z[0], 1 / Y).max() <= 1e-5


def test_rim_of_a_hole(around, solve, hole):
    scene, A, perimeter = hole(around({"rim": RIM}, frequencies=[LOW], rows=2, columns=2))
    Cp = parallel_capacitance(solve(scene, rtol=1e-3).Z, scene.frequencies).item()
    assert Cp == pytest.approx(5e-9 * A + RIM["mutual"] * perimeter, rel=1e-6)


def test_all_terms_on_triangles(around, solve, on_triangles):
    """The same skin by another mesh, with a touch that is no pixel."""
    given = {
        "rim": RIM,
        "thickness": True,
        "body": {"distance": 5e-3},
    }
    scene = around(given, {"thickness": 4e-3}, rows=2, columns=2)
    press = "1,2:1.7:3pF+rect(0.03,0.05,0.02,0.03):1.3:2pF"
    rung, answer = on_triangles(scene, press, 1e-4), solve(scene, press, 1e-5)
    off = relative_difference(rung.Z, answer.Z)
    assert (off <= rung.error + np.stack(answer.relative_errors)).all()


def test_a_bent_skin_is_the_flat_one(around, solve):
    """To a cylinder: no length changes; stretched to twice the length all terms go with it."""
    given = {"rim": RIM, "thickness": True, "body": {"distance": 5e-3}}
    flat = around(given, {"thickness": 4e-3}, columns=2)
    told = flat.model_dump(by_alias=True, exclude_none=True)
    told["skin"]["shape"] = {"kind": "cylinder", "radius": 0.04}
    bent = type(flat).model_validate(told)
    press = "1,2:1.7:3pF"
    np.testing.assert_array_equal(solve(bent, press, 1e-4).Z, solve(flat, press, 1e-4).Z)


def folded(path):
    """An oblong of 100 x 80 mm as triangles in space, folded by 60 degrees along its middle."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 0.1, 5), np.linspace(0, 0.08, 4)))
    i, j = (each.ravel() for each in np.meshgrid(np.arange(4), np.arange(3)))
    low, near = 5 * j + i, np.tile(i < 2, 2)
    cells = np.concatenate([[low, low + 1, low + 6], [low, low + 6, low + 5]], axis=1).T
    beyond, edge = np.maximum(x - 0.05, 0.0), np.flatnonzero(x == 0)
    p = np.stack([np.minimum(x, 0.05) + beyond / 2, y, beyond * math.sqrt(3) / 2], axis=1)
    blocks = [("triangle", cells[near]), ("triangle", cells[~near])]
    blocks.append(("line", np.stack([edge[:-1], edge[1:]], axis=1)))
    tags = [np.full(len(block), tag) for tag, (_, block) in enumerate(blocks, 1)]
    names = {"near": np.array([1, 2]), "far": np.array([2, 2]), "left": np.array([3, 1])}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    mesh = meshio.Mesh(p, blocks, cell_data=data, field_data=names)
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return str(path)


def test_a_mesh_in_space_is_the_flat_skin(around, solve, tmp_path):
    given = {"rim": RIM, "thickness": True, "edges": True, "body": {"distance": 5e-3}}
    flat = around(given, {"thickness": 4e-3}, columns=2, frequencies=[1e4])
    told = flat.model_dump(by_alias=True, exclude_none=True)
    told["skin"]["mesh"] = folded(tmp_path / "folded.msh")
    told["pixels"]["groups"] = [["near", "far"]]
    in_space, press = type(flat).model_validate(told), "1,1:1.7:3pF"
    answers = [solve(each, press, 1e-3).Z for each in (in_space, flat)]
    assert relative_difference(*answers).max() <= 2e-3


def test_a_stretched_skin_is_a_larger_one(around, solve):
    """Of thinner foam; all terms go with its own lengths and areas."""
    skin = {"thickness": 4e-3, "relative_permittivity": 2.2}
    at_rest = around(None, columns=2)
    told = at_rest.model_dump(by_alias=True, exclude_none=True)
    told["skin"] |= {"foam": skin, "stretch": {"x": 1.4, "y": 0.9}}
    scene = type(at_rest).model_validate(told)
    given = {"rim": RIM, "thickness": True, "edges": True, "body": {"distance": 5e-3}}
    larger = scene.parts.evened.scene.model_dump(by_alias=True, exclude_none=True)
    assert larger["skin"]["length"] == pytest.approx(0.14) and "stretch" not in larger["skin"]
    stretched, flat = (
        type(scene).model_validate(each | {"surroundings": given}) for each in (told, larger)
    )
    answers = [solve(each, "1,2:1.7:3pF", 1e-5).Z for each in (stretched, flat)]
    assert relative_difference(*answers).max() <= 2e-5


def test_a_finger_that_pushes_in(around):
    """Deeper ones at a place share its mesh, not the finger of the one before."""
    foam = {
        "thickness": 4e-3,
        "mechanics": {
            "porosity": 0.6,
            "modulus": 3e4,
            "tension": 20.0,
            "effective_medium": "constant",
        },
    }
    scene = around({"body": {"distance": 5e-3}}, foam, rows=2, columns=2)
    kept = Solver(scene.parts, 1e-2)
    depths = ("1mm:rod", "1mm:9pF", "1.1mm:9pF")
    presses = [parse_press(f"2,2:{depth}", 2.0, scene.parts.skin, scene.press) for depth in depths]
    Z = [kept.solve(press).Z for press in presses]
    assert relative_difference(Z[1], Z[0]).max() > 2e-2
    assert relative_difference(Z[1], Solver(scene.parts, 1e-2).solve(presses[1]).Z).max() <= 1e-3
    assert relative_difference(Z[2], Solver(scene.parts, 1e-2).solve(presses[2]).Z).max() <= 1e-3


def test_fields_are_those_of_one_volt_at_high_and_low_at_earth(around):
    scene = around({"body": {"distance": 5e-3}}, contacts={"top-left": {}, "bottom-right": {}})
    found = Elements(scene.parts.skin, scene.parts.setup).fields(
        parse_press("1,1:2.0:4pF", 2.0, scene.parts.skin, scene.press), [1e4], "meter"
    )
    x = found.x[0]
    assert np.abs(found.potential[0, 0, x < 1e-9] - 1).max() < 1e-9
    assert np.abs(found.potential[1, 0, x > 0.1 - 1e-9]).max() < 1e-9
    assert np.abs(found.potential[0, 0]).min() < 0.999, "earth draws current through the sheet"
    Z = (
        Elements(scene.parts.skin, scene.parts.setup)
        .fields(parse_press("1,1:2.0002:4pF", 2.0, scene.parts.skin, scene.press), [1e4], "meter")
        .Z
    )
    change = np.log(Z.real / found.Z.real).item() / 1e-4
    corners = found.x[:, found.cells]
    area = np.abs(np.prod(corners[:, 2] - corners[:, 0], axis=0))
    whole = area @ found.by_rise_Rs[0, found.cells].mean(axis=0)
    assert whole == pytest.approx(change, rel=3e-2)


@pytest.mark.parametrize(
    ("given", "press", "wrong"),
    [
        (
            {"rim": True, "body": {"distance": 5e-3, "potential": "high"}},
            "none",
            "rim = true` is computed towards a body at earth",
        ),
        ({"low": "floating"}, "1,1:touch:2pF", "has no return path"),
    ],
)
def test_what_is_not_taken_is_refused(around, solve, given, press, wrong):
    with pytest.raises(InputError, match=wrong):
        solve(around(given), press)
