"""Outlines of skins: what is accepted, what is refused in one line, and where foils lie on them.

Lengths that intervals share with others. Where stretched and wrapped skins are in space: lengths,
tangents, and what is refused.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.scene.form import Curve, Cylinder, Sphere, Stretch
from rcskin.simulator.scene.planar import Circle, area, gap, inside, regular, shared, sides
from rcskin.simulator.scene.scene_files import BUILTIN, parse_scene, scene_text
from rcskin.simulator.scene.wiring_checks import conductor_groups
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

SHEET = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")
SQUARE = "[[0.01, 0.01], [0.11, 0.01], [0.11, 0.11], [0.01, 0.11]]"
L = "[[0, 0], [0.12, 0], [0.12, 0.05], [0.05, 0.05], [0.05, 0.12], [0, 0.12]]"

MESH = """[skin.mesh]
source = "a.msh"
points = "0 0, 0.1 0, 0 0.1"
triangles = "0 1 2"
"""


def text_of(outline, edge="outline", other="outline"):
    """The 3x3 sheet with an outline, and its foils along other edges."""
    text = SHEET.replace("[skin.top]", f"[skin.outline]\n{outline}\n[skin.top]", 1)
    start, middle, end = text.split('edge = "left"')
    return f'{start}edge = "{edge}"{middle}edge = "{other}"{end}'


def scene_of(outline, *edges):
    return parse_scene(text_of(outline, *edges), "mine.toml")


@pytest.mark.parametrize(
    ("outline", "edges"),
    [
        (f"points = {L}", ["outline.5", "outline.5"]),
        (f"points = {SQUARE}\nholes = [{{circle = [0.05, 0.05, 0.02]}}]", ["hole1", "outline.4"]),
        ("circle = [0.06, 0.06, 0.06]", ["outline", "outline"]),
        (
            "circle = [0.06, 0.06, 0.05]\n"
            "holes = [{points = [[0.05, 0.05], [0.05, 0.07], [0.07, 0.07]]}]",
            ["hole1.3", "hole1"],
        ),
    ],
)
def test_scenes_with_outlines_are_written_and_read_back(outline, edges):
    scene = scene_of(outline, *edges)
    assert parse_scene(scene_text(scene), "text") == scene
    assert not scene.parts.skin.uniform


def test_scenes_without_outline_are_written_as_before():
    text = scene_text(parse_scene(SHEET, "text"))
    assert not any(word in text for word in ("outline", "mesh", "groups"))


@pytest.mark.parametrize(
    ("outline", "told"),
    [
        ("", "`skin.outline` needs either points = [[x, y], ...] or circle = [x, y, radius]"),
        (f"points = {SQUARE}\ncircle = [0.05, 0.05, 0.01]", "`skin.outline` needs either points"),
        ("points = [[0, 0], [0.1, 0], [0.1, 0.2]]", "outline must lie within y = 0..0.12 m"),
        ("circle = [0.05, 0.05, 0.06]", "outline must lie within x = 0..0.12 m, got -0.01..0.11 m"),
        (
            "points = [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1]]",
            "outline must not meet itself: its sides 1 and 3 cross",
        ),
        (
            "points = [[0, 0], [0.1, 0], [0.1, 0.1], [0.05, 0], [0, 0.1]]",
            "outline must not meet itself",
        ),
        ("points = [[0, 0], [0.1, 0], [0.05, 0], [0.05, 0.1]]", "outline turns back on itself at"),
        ("points = [[0, 0], [0.1, 0], [0, 0]]", "outline has a side 3 shorter than"),
        (
            f"points = {SQUARE}\nholes = [{{circle = [0.1, 0.05, 0.02]}}]",
            "outline.holes[1] must lie inside the outline",
        ),
        (
            f"points = {L}\nholes = [{{circle = [0.1, 0.1, 0.01]}}]",
            "outline.holes[1] must lie inside the outline",
        ),
        (
            f"points = {SQUARE}\nholes = [{{circle = [0.5, 0.06, 0.01]}}]",
            "must lie within x = 0..0.12 m, got 0.49..0.51",
        ),
        (
            f"points = {SQUARE}\n"
            "holes = [{circle = [0.05, 0.05, 0.01]}, {circle = [0.06, 0.05, 0.01]}]",
            "outline.holes[1] and outline.holes[2] must lie at least",
        ),
        (
            f"points = {SQUARE}\n"
            "holes = [{circle = [0.05, 0.05, 0.02]}, {circle = [0.05, 0.05, 0.01]}]",
            "outline.holes[1] and outline.holes[2] must lie at least",
        ),
        (
            "circle = [0.06, 0.06, 0.05]\nholes = [{circle = [0.06, 0.06, 1e-9]}]",
            "outline.holes[1].circle must have a radius of at least",
        ),
    ],
)
def test_outlines_that_bound_no_skin_are_refused(outline, told):
    assert told in refusal_of(scene_of, outline)


def test_the_command_line_refuses_in_one_line(tmp_path, refused):
    path = tmp_path / "bad.toml"
    path.write_text(text_of("circle = [0, 0, 0.1]"), encoding="utf-8")
    assert f"{path}: `skin` outline must lie within x = 0..0.12 m, got -0.1..0.1 m" in refused(
        "sweep", path, "-o", tmp_path / "out.csv"
    )


@pytest.mark.parametrize(
    ("edges", "told"),
    [
        (["left", "outline"], "`contact[1].edge` must be 'outline', 'outline.1'..'outline.6' or "),
        (["outline", "outline.7"], "`contact[2].edge` must be 'outline', 'outline.1'..'outline.6'"),
        (["outline", "hole2"], "or 'hole1', got 'hole2'"),
        (["outline", "hole1.1"], "or 'hole1', got 'hole1.1'"),
        (["outline.0", "outline"], "got 'outline.0'"),
    ],
)
def test_edges_that_an_outline_lacks_are_refused(edges, told):
    assert told in refusal_of(
        scene_of, f"points = {L}\nholes = [{{circle = [0.02, 0.02, 0.01]}}]", *edges
    )


def test_an_outline_or_a_mesh():
    with pytest.raises(InputError, match="`skin` takes outline or mesh, got both"):
        parse_scene(f"{text_of('circle = [0.06, 0.06, 0.05]')}\n{MESH}", "mine.toml")


def test_groups_are_as_many_as_pixels():
    text = SHEET.replace("rows = 3", 'groups = [["a", "b", "c"]]\nrows = 3')
    with pytest.raises(InputError, match="`pixels` groups must be 3 rows of 3 names"):
        parse_scene(text, "mine.toml")


FOILS = """[[contact]]
name = "top-more"
electrode = "top"
edge = "{edge}"
span = [{span}]
[[interface]]"""


def with_another(first, edge, span):
    """The L with foils on top along `first` and along a span of `edge`."""
    text = text_of(f"points = {L}", first, "outline.3")
    return parse_scene(text.replace("[[interface]]", FOILS.format(edge=edge, span=span)), "m.toml")


@pytest.mark.parametrize(
    ("first", "edge", "span"),
    [
        ("outline.2", "outline.2", "0.5, 1.0"),
        ("outline", "outline.2", "0.5, 1.0"),
        ("outline.2", "outline", "0.3, 0.4"),
    ],
)
def test_foils_along_one_stretch_of_an_outline_overlap(first, edge, span):
    with pytest.raises(InputError, match="contacts 'top-left' and 'top-more' overlap"):
        with_another(first, edge, span)


def test_foils_that_meet_at_a_corner_are_one_conductor():
    scene = with_another("outline.2", "outline.3", "0.0, 0.5")
    assert conductor_groups(scene.contacts, scene.skin) == [0, 1, 0]
    apart = with_another("outline.2", "outline.3", "0.2, 0.5")
    assert conductor_groups(apart.contacts, apart.skin) == [0, 1, 2]
    closing = with_another("outline.6", "outline.1", "0.0, 0.5")
    assert conductor_groups(closing.contacts, closing.skin) == [0, 1, 0]


def test_foils_all_but_touching_are_refused():
    with pytest.raises(InputError, match="'top-left' and 'top-more' must touch, or end at least"):
        with_another("outline.2", "outline.3", "1e-7, 0.5")


def test_a_circle_runs_anticlockwise_from_its_rightmost_point():
    circle = Curve(circle=(0.06, 0.05, 0.04))
    assert circle.marks == pytest.approx([0, 2 * np.pi * 0.04])
    assert circle.at(0) == pytest.approx((0.10, 0.05))
    assert circle.at(np.pi * 0.02) == pytest.approx((0.06, 0.09))
    polygon = Curve(points=tuple(map(tuple, regular(0.06, 0.05, 0.04, 2000).tolist())))
    for part in (0.1, 0.45, 0.9):
        at = (circle.at(part * circle.marks[-1]), polygon.at(part * polygon.marks[-1]))
        assert at[0] == pytest.approx(at[1], abs=1e-6)


@pytest.mark.parametrize(
    ("other", "apart"),
    [
        (Circle(3, 0, 1), 1),
        (Circle(0.1, 0, 0.5), 0.4),
        (Circle(0, 0.1, 3), 1.9),
        (Circle(1, 0, 1), 0),
        (np.array([[2.0, -1], [3, 0], [2, 1]]), 1),
        (np.array([[-3.0, -3], [3, -3], [3, 3], [-3, 3]]), 2),
        (np.array([[-0.3, -0.4], [0.6, 0], [0, 0.6]]), 0.4),
    ],
)
def test_the_gap_between_a_circle_and_what_is_beside_within_or_around_it(other, apart):
    assert Circle(0, 0, 1).gap(other) == pytest.approx(apart)


def test_inside_and_apart():
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    x = np.random.default_rng(1).uniform(-1, 2, (2, 5, 40))
    assert (inside(square, x) == ((x > 0) & (x < 1)).all(axis=0)).all()
    assert (inside(square[::-1], x) == inside(square, x)).all()
    assert gap(sides(square), sides(square + [3, 0])).min() == pytest.approx(2)
    assert gap([[(0, 0), (1, 1)]], [[(0, 1), (1, 0)]])[0, 0] == 0
    assert area(square) == 1 and area(square[::-1]) == -1


INSIDE = st.lists(st.integers(-1500, 1500), max_size=6, unique=True)
LINES = INSIDE.map(lambda at: np.array([-2000, *sorted(at), 2000]) / 1000)


@given(spans=LINES, cells=LINES)
def test_every_interval_is_shared_out(spans, cells):
    np.testing.assert_allclose(shared(spans, cells).sum(axis=0), 1.0, rtol=1e-12)


SIDES = (0.12, 0.08)
SHAPES = [Cylinder(radius=0.03), Cylinder(radius=0.03, axis="x"), Sphere(radius=0.05)]


def inner(count=50):
    return np.random.default_rng(2).uniform(0, 1, (2, count)) * np.array(SIDES)[:, None]


@pytest.mark.parametrize("shape", SHAPES)
def test_tangents_are_the_derivatives_of_the_position(shape):
    x, step = inner(), 1e-6
    for axis in range(2):
        away = step * np.eye(2)[:, axis, None]
        slope = (shape.position(x + away, SIDES) - shape.position(x - away, SIDES)) / (2 * step)
        np.testing.assert_allclose(shape.tangents(x, SIDES)[:, axis], slope, atol=1e-8)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_middle_of_the_skin_stays_where_it_is_and_flat(shape):
    middle = np.array(SIDES) / 2
    np.testing.assert_allclose(shape.position(middle, SIDES), [*middle, 0], atol=1e-15)
    np.testing.assert_allclose(shape.tangents(middle, SIDES), np.eye(3, 2), atol=1e-15)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_of_huge_radius_is_flat(shape):
    wide = shape.model_copy(update={"radius": 1e9})
    flat = np.stack([*inner(), np.zeros(50)])
    np.testing.assert_allclose(wide.position(inner(), SIDES), flat, atol=1e-11)


def test_a_cylinder_is_at_its_radius_from_its_axis():
    around_y, around_x = (shape.position(inner(), SIDES) for shape in SHAPES[:2])
    np.testing.assert_allclose(np.hypot(around_y[0] - 0.06, around_y[2] + 0.03), 0.03, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(around_x[1] - 0.04, around_x[2] + 0.03), 0.03, rtol=1e-12)


def test_a_sphere_is_at_its_radius_and_keeps_distances_from_the_middle():
    x, radius = inner(), SHAPES[2].radius
    at = SHAPES[2].position(x, SIDES) - np.array([0.06, 0.04, -radius])[:, None]
    np.testing.assert_allclose(np.sqrt(np.sum(at**2, axis=0)), radius, rtol=1e-12)
    along = radius * np.arccos(at[2] / radius)
    np.testing.assert_allclose(along, np.hypot(x[0] - 0.06, x[1] - 0.04), rtol=1e-7)


def test_a_draped_sphere_is_shorter_across_by_sin_over_angle():
    x, shape = inner(), SHAPES[2]
    F = shape.tangents(x, SIDES)
    area = np.sqrt(np.linalg.det(np.einsum("ki...,kj...->...ij", F, F)))
    angle = np.hypot(x[0] - 0.06, x[1] - 0.04) / shape.radius
    np.testing.assert_allclose(area, np.sin(angle) / angle, rtol=1e-12)


def test_a_skin_wraps_around_a_cylinder_once_at_most():
    Cylinder(radius=0.12 / (2 * np.pi)).check(SIDES)
    with pytest.raises(ValueError, match=r"`shape.radius` must be >= 0.0191 m, .* at most once"):
        Cylinder(radius=0.019).check(SIDES)
    Cylinder(radius=0.019, axis="x").check(SIDES)


def test_a_sphere_too_small_for_the_skin_is_refused():
    Sphere(radius=0.0256).check(SIDES)
    with pytest.raises(ValueError, match=r"`shape.radius` must be >= 0.0255 m, .* got 0.025"):
        Sphere(radius=0.025).check(SIDES)


@given(st.floats(0.5, 2), st.floats(0, 0.5))
def test_a_strip_narrows_by_its_poisson_ratio_and_keeps_its_volume_at_one_half(x, ratio):
    along, across = Stretch(x=x, sheet_poisson_ratio=ratio).ratios
    assert (along, across) == (x, pytest.approx(x**-ratio))
    thickness = (along * across) ** -Stretch(sheet_poisson_ratio=ratio).thinning[0]
    assert thickness == pytest.approx(x**-ratio), "as much across the sheet as along its width"
    assert Stretch(x=x, y=1.1).ratios == (x, 1.1)
    assert Stretch(sheet_poisson_ratio=0.5).thinning[0] == 1
