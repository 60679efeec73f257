"""What a press by depth or force is, whatever the numbers."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics import adaptive
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.models.mechanics.membrane import Membrane
from rcskin.simulator.press.press import Press, every_press, parse_press
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.errors import ToleranceError

X, Y = np.meshgrid(np.linspace(0, 0.12, 61), np.linspace(0, 0.04, 21))
PLACES = np.stack([X, Y])
BOTH_REGIMES = pytest.mark.parametrize("stress_strain", ["linear", "elastomer"])


def press_of(text):
    """A press, read."""
    return parse_press(text, 2.0)


def test_a_press_without_depth_or_force_leaves_the_foam_alone(foam_scene):
    press = press_of("1,2:3+disc(0.02,0.02,0.01)")
    found = deformation(foam_scene().parts.skin, press, 1e-3)
    assert found.sharp is press
    np.testing.assert_array_equal(found.factor(PLACES), np.ones(X.shape))


@BOTH_REGIMES
def test_without_tension_a_press_is_as_sharp_as_its_applicator(foam_scene, stress_strain):
    scene = foam_scene(0.0, stress_strain)
    found = deformation(
        scene.parts.skin, press_of("1,2:2mm+disc(0.02,0.02,0.01):1mm+1,3:1.5"), 1e-6
    )
    mechanics = scene.skin.foam.mechanics
    two, one = mechanics.factor(np.array([0.5, 0.25]))
    assert str(found.sharp) == f"1,2:{two!s}+1,3:1.5+disc(0.02,0.02,0.01):{one!s}"
    assert found.error == 0 and found.sharp.indented == ()
    inside = np.hypot(X - 0.02, Y - 0.02) < 0.0099
    outside = (np.hypot(X - 0.02, Y - 0.02) > 0.0101) & ((X < 0.039) | (X > 0.081))
    assert (found.factor(PLACES)[inside] == one).all()
    assert (found.factor(PLACES)[outside] == 1).all()
    pixel = mechanics.elastic.stress(np.array(0.5)) * 0.04 * 0.04
    assert found.force == pytest.approx((pixel, np.pi * 1e-4 * mechanics.elastic.stress(0.25)))


@BOTH_REGIMES
@pytest.mark.parametrize("tension", [0.0, 50.0])
def test_the_force_of_a_depth_takes_it_there(foam_scene, tension, stress_strain):
    scene = foam_scene(tension, stress_strain)
    by_depth = deformation(scene.parts.skin, press_of("disc(0.06,0.02,0.01):1.3mm"), 1e-2)
    by_force = deformation(
        scene.parts.skin, press_of(f"disc(0.06,0.02,0.01):{by_depth.force[0]!r}N"), 1e-2
    )
    assert by_force.depth[0] == pytest.approx(1.3e-3, rel=1e-4)


@BOTH_REGIMES
def test_more_depth_takes_more_force_and_deflects_more_everywhere(foam_scene, stress_strain):
    scene = foam_scene(50.0, stress_strain)
    each = [
        deformation(scene.parts.skin, press_of(f"1,2:{depth}mm"), 1e-2) for depth in (0.5, 1.5, 2.5)
    ]
    assert (np.diff([found.force[0] for found in each]) > 0).all()
    assert (np.diff([found.deflection(PLACES) for found in each], axis=0) >= -1e-7).all()
    for found in each:
        assert found.deflection(np.array([0.06, 0.02])) == pytest.approx(found.depth[0], rel=1e-12)


def test_linear_foam_deflects_in_proportion(foam_scene):
    one, two = (deformation(foam_scene().parts.skin, press_of(f"1,2:{d}mm"), 1e-3) for d in (1, 2))
    assert two.force[0] == pytest.approx(2 * one.force[0], rel=1e-6)
    np.testing.assert_allclose(two.w(PLACES), 2 * one.w(PLACES), atol=1e-6)


def test_distant_linear_presses_add_up(foam_scene):
    texts = "disc(0.02,0.02,0.005):1mm", "disc(0.1,0.02,0.005):2mm"
    first, second, both = (
        deformation(foam_scene(20.0).parts.skin, press_of(text), 1e-3)
        for text in (*texts, "+".join(texts))
    )
    np.testing.assert_allclose(both.force, (*first.force, *second.force), rtol=1e-5)
    np.testing.assert_allclose(both.w(PLACES), first.w(PLACES) + second.w(PLACES), atol=2e-6)


@BOTH_REGIMES
def test_a_press_in_the_middle_is_as_symmetric_as_the_skin(foam_scene, stress_strain):
    found = deformation(
        foam_scene(50.0, stress_strain).parts.skin, press_of("rect(0.06,0.02,0.02,0.01):2mm"), 1e-3
    )
    factor = found.factor(PLACES)
    np.testing.assert_allclose(factor, factor[::-1], rtol=3e-3)
    np.testing.assert_allclose(factor, factor[:, ::-1], rtol=3e-3)


def test_a_polygon_of_four_corners_is_the_rectangle(foam_scene):
    rectangle = press_of("rect(0.06,0.02,0.02,0.01):2mm")
    polygon = press_of("poly(0.05,0.015,0.05,0.025,0.07,0.025,0.07,0.015):2mm")
    one, other = (
        deformation(foam_scene().parts.skin, press, 1e-3) for press in (rectangle, polygon)
    )
    assert one.force == pytest.approx(other.force, rel=1e-6)
    np.testing.assert_allclose(one.factor(PLACES), other.factor(PLACES), rtol=2e-3)


@pytest.mark.parametrize("tension", [0.0, 50.0])
def test_the_deeper_of_two_over_each_other_counts(foam_scene, tension):
    press = press_of("rect(0.05,0.02,0.02,0.02):2mm+rect(0.055,0.02,0.02,0.02):1mm")
    found = deformation(foam_scene(tension).parts.skin, press, 1e-2)
    assert found.sharp is None
    deflection = found.deflection(np.array([[0.055, 0.0649], [0.02, 0.02]]))
    assert deflection[0] == pytest.approx(2e-3, rel=1e-12)
    assert deflection[1] == pytest.approx(1e-3, rel=1e-2 if tension else 0)


def test_skins_of_much_tension_and_short_sides_go_down_whole(foam_scene):
    found = deformation(foam_scene(1e7).parts.skin, press_of("1,2:1mm"), 1e-3)
    np.testing.assert_allclose(found.deflection(PLACES), 1e-3, rtol=1e-3)
    assert found.force[0] == pytest.approx(30e3 / 4 * 0.12 * 0.04, rel=1e-3)


def test_holes_press_nothing(foam_scene):
    """The foam that a disc presses is that beside the hole under it."""
    outline = {
        "points": [(0, 0), (0.12, 0), (0.12, 0.04), (0, 0.04)],
        "holes": [{"circle": (0.06, 0.02, 0.005)}],
    }
    contacts = [
        {"name": f"{e}-left", "electrode": e, "edge": "outline.4"} for e in ("top", "bottom")
    ]
    scene = foam_scene(0.0)
    given = scene.model_dump(by_alias=True, exclude_none=True)
    given["skin"]["outline"], given["contact"] = outline, contacts
    scene = type(scene).model_validate(given)
    found = deformation(scene.parts.skin, press_of("disc(0.06,0.02,0.01):2mm"), 1e-2)
    assert found.force[0] == pytest.approx(30e3 * 0.5 * np.pi * (0.01**2 - 0.005**2), rel=1e-9)
    with pytest.raises(InputError, match=r"disc\(0.06,0.02,0.001\): must touch the skin"):
        deformation(scene.parts.skin, press_of("disc(0.06,0.02,0.001):1N"), 1e-2)


@pytest.mark.parametrize("tension", [0.0, 50.0])
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2:2.69mm", r"depth must be <= 0.002677 m, where foam of 0.004 m .* got 0.00269m"),
        ("1,2:1e6N", r"force must leave the depth <= 0.002677 m"),
        ("disc(0.06,0.02,0.01):1N+disc(0.065,0.02,0.01):1N", "must not meet another touch"),
        ("disc(0.06,0.05,0.02):1mm", "touches must lie within y = 0..0.04 m"),
    ],
)
def test_impossible_presses_are_refused(foam_scene, tension, text, message):
    with pytest.raises(InputError, match=message):
        deformation(foam_scene(tension, "elastomer").parts.skin, press_of(text), 1e-2)


def test_a_spread_too_short_to_resolve_is_refused(foam_scene):
    with pytest.raises(
        ToleranceError, match="if the tension hardly spreads the press, set it to 0"
    ):
        deformation(foam_scene(1e-7).parts.skin, press_of("1,2:2mm"), 1e-3)


def test_depths_need_mechanics(make_scene):
    with pytest.raises(InputError, match="depth and force need the table skin.foam.mechanics"):
        deformation(make_scene().parts.skin, press_of("1,1:2mm"), 1e-2)


def test_every_press_is_as_the_scene_says(foam_scene):
    scene = foam_scene(press={"depth": 2e-3})
    assert list(map(str, every_press(scene.parts.skin, scene.press)))[:2] == ["none", "1,1:0.002m"]
    made = foam_scene(press={"force": 3.0})
    assert every_press(made.parts.skin, made.press)[3] == Press(press_of("1,3:3N").touches)


def test_a_tolerance_out_of_reach_is_refused_before_meshes_grow(foam_scene, monkeypatch):
    sizes = []

    def noted(mesh, *more):
        sizes.append(mesh.nelements)
        return Membrane(mesh, *more)

    monkeypatch.setattr(adaptive, "Membrane", noted)
    with pytest.raises(ToleranceError, match="more than 60000 triangles"):
        deformation(foam_scene(stress_strain="elastomer").parts.skin, press_of("1,2:2mm"), 1e-11)
    assert max(sizes) < 5_000
