"""Maps: what factors they are where, how random ones vary, how well grids stand for smooth ones.

Maps from tables and pictures, and scenes that hold them. A mesh in another unit than m is refused
before any solving, one off the grid is warned of.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from rcskin.simulator.scene.factor_maps import (
    SHORTEST,
    Constant,
    Gradient,
    Grid,
    Random,
    random_field,
)
from rcskin.simulator.scene.mesh_data import check_extent, off_grid
from rcskin.simulator.scene.mesh_file import MeshSurface
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

SIDES = (0.12, 0.08)


def places(columns=41, rows=31):
    """On an even grid over the skin, its edges included; shape (2, row, column)."""
    x, y = np.linspace(0, SIDES[0], columns), np.linspace(0, SIDES[1], rows)
    return np.stack(np.meshgrid(x, y))


def test_a_gradient_rises_by_so_much_from_edge_to_edge():
    of_place = Gradient(x=0.4, y=-0.2, middle=1.5)
    corners = np.array([[0.0, 0.12, 0.0, 0.12, 0.06], [0.0, 0.0, 0.08, 0.08, 0.04]])
    expected = [1.4, 1.8, 1.2, 1.6, 1.5]
    np.testing.assert_allclose(of_place.factors(corners, SIDES), expected, rtol=1e-12)
    assert of_place.uniform is None
    assert Gradient(middle=2.0).uniform == 2.0


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.1, 2))
def test_a_gradient_that_is_accepted_is_positive_everywhere(x, y, middle):
    try:
        of_place = Gradient(x=x, y=y, middle=middle)
    except ValueError:
        assert abs(x) + abs(y) >= 2 * middle
    else:
        assert of_place.factors(places(), SIDES).min() > 0


@pytest.mark.parametrize("apart", [0.0, 0.5, 1.0, 2.0])
def test_random_fields_correlate_by_their_kernel(apart):
    """Means over 4000 seeds at places that are so many correlation lengths apart."""
    length = 0.02
    step = apart * length / np.sqrt(2)
    x = np.array([[0.01, 0.01 + step], [0.02, 0.02 + step]])
    first, second = np.array([random_field(x, SIDES, length, seed) for seed in range(4000)]).T
    assert np.mean(first * second) == pytest.approx(np.exp(-(apart**2) / 2), abs=0.06)
    assert np.mean(first) == pytest.approx(0, abs=0.06)
    assert np.mean(first**2) == pytest.approx(1, abs=0.08)


def test_far_edges_of_a_random_field_know_nothing_of_each_other():
    x = np.array([[0.0, 0.12], [0.04, 0.04]])
    first, second = np.array([random_field(x, SIDES, 0.01, seed) for seed in range(2000)]).T
    assert np.mean(first * second) == pytest.approx(0, abs=0.06)


@pytest.mark.parametrize("distribution", ["lognormal", "normal"])
def test_random_maps_have_mean_one_and_their_deviation(distribution):
    drawn = [
        Random(deviation=0.1, correlation_length=0.004, distribution=distribution, seed=seed)
        for seed in range(40)
    ]
    factors = np.array([each.factors(places(), SIDES) for each in drawn])
    assert factors.mean() == pytest.approx(1, abs=0.005)
    assert factors.std() == pytest.approx(0.1, rel=0.03)
    assert factors.min() > 0


def test_a_seed_gives_the_same_map_at_any_places_and_another_one_another():
    one, other = (Random(deviation=0.3, correlation_length=0.01, seed=seed) for seed in (1, 2))
    few, many = places(5, 4), places(9, 7)
    np.testing.assert_array_equal(one.factors(many, SIDES), one.factors(many, SIDES))
    np.testing.assert_allclose(
        one.factors(few, SIDES), one.factors(many, SIDES)[::2, ::2], rtol=1e-12
    )
    assert np.abs(one.factors(few, SIDES) - other.factors(few, SIDES)).max() > 0.1


def test_a_normal_map_that_comes_near_zero_is_refused():
    drawn = Random(deviation=0.3, correlation_length=0.003, distribution="normal", seed=1)
    with pytest.raises(ValueError, match=r"deviation must leave the factor >= 0.05 everywhere"):
        drawn.check(SIDES)
    drawn.model_copy(update={"distribution": "lognormal"}).check(SIDES)
    too_wide = Random(deviation=0.5, correlation_length=0.05, distribution="normal")
    with pytest.raises(ValueError, match=r"deviation must be <= 0.3 for a normal factor, got 0.5"):
        too_wide.check(SIDES)


def test_a_field_finer_than_a_mesh_can_follow_is_refused():
    least = SHORTEST * SIDES[0]
    Random(deviation=0.1, correlation_length=least).check(SIDES)
    with pytest.raises(ValueError, match="correlation_length must be >= 0.0024 m"):
        Random(deviation=0.1, correlation_length=0.99 * least).check(SIDES)


def test_a_grid_is_bilinear_between_values_of_which_the_outer_lie_on_the_edges():
    values = ((1.0, 2.0, 4.0), (3.0, 5.0, 6.0))
    of_place, (length, width) = Grid(values=values), SIDES
    x = np.array(
        [[0, length / 2, length, 0, length, length / 4], [0, 0, 0, width, width, width / 2]]
    )
    expected = [1.0, 2.0, 4.0, 3.0, 6.0, (1 + 2 + 3 + 5) / 4]
    np.testing.assert_allclose(of_place.factors(x, SIDES), expected, rtol=1e-12)
    assert of_place.kinks(SIDES) == ((length / 2,), ())
    assert of_place.shortest(SIDES) == pytest.approx(min(length / 2, width))


def test_grids_of_one_row_or_value_do_not_vary_along_what_they_lack():
    row = Grid(values=((1.0, 3.0),)).factors(places(), SIDES)
    np.testing.assert_array_equal(row, np.broadcast_to(row[:1], row.shape))
    one = Grid(values=((2.5,),))
    np.testing.assert_array_equal(one.factors(places(), SIDES), 2.5)
    assert (one.uniform, one.shortest(SIDES), one.kinks(SIDES)) == (2.5, np.inf, ((), ()))


def test_a_grid_misses_a_smooth_map_by_the_square_of_its_step_up_to_the_edges():
    def smooth(x):
        return 1.5 + np.sin(20 * x[0]) * np.exp(5 * x[1]) / 2

    missed = []
    for count in (9, 17, 33):
        values = tuple(map(tuple, smooth(places(count, count)).tolist()))
        found = Grid(values=values).factors(places(301, 203), SIDES)
        missed.append(np.abs(found - smooth(places(301, 203))).max())
    orders = np.log2(np.divide(missed[:-1], missed[1:]))
    assert (orders > 1.9).all()


def test_constants_are_uniform_without_lines_or_lengths():
    of_place = Constant(value=0.7)
    assert (of_place.uniform, of_place.kinks(SIDES)) == (0.7, ((), ()))
    assert of_place.shortest(SIDES) == np.inf
    np.testing.assert_array_equal(of_place.factors(places(), SIDES), np.full((31, 41), 0.7))


@pytest.mark.parametrize(
    ("kind", "given", "told"),
    [
        (Constant, {"value": 0.0}, "must be from 1e-6 to 1e6 times the nominal value, got 0"),
        (Gradient, {"x": 1.5, "y": 0.6}, r"\|x\| \+ \|y\| < 2, got 2.1"),
        (Grid, {"values": ((1.0, 2.0), (3.0,))}, "must be rows of equally many values"),
        (Grid, {"values": ((1.0, -2.0),)}, "must be from 1e-6 to 1e6"),
        (Grid, {"values": ((1.0,) * 129,)}, "must be at most 128 x 128, got 1 x 129"),
        (Random, {"deviation": -0.1, "correlation_length": 0.1}, "must be from 0 to 1"),
        (Random, {"deviation": 0.1, "correlation_length": 0.0}, "must be from 1e-5 to 1000 m"),
    ],
)
def test_values_out_of_range_are_named(kind, given, told):
    with pytest.raises(ValueError, match=told):
        kind(**given)


@pytest.fixture
def mapped(tmp_path):
    """A scene file with `[skin.PART.map]` of the kind file, and further lines in it."""

    def mapped(path, *lines, part="top"):
        text = (BUILTIN / "sheet-3x3.toml").read_text()
        table = "\n".join([f"[skin.{part}.map]", 'kind = "file"', f'path = "{path}"', *lines])
        scene = tmp_path / "mine.toml"
        scene.write_text(f"{text}\n{table}\n")
        return scene

    return mapped


def test_a_table_is_read_from_the_folder_of_its_scene_first_line_at_the_bottom(mapped, tmp_path):
    (tmp_path / "map.csv").write_text("1.0,2.0,3\n4,5,6e0\n\n")
    scene = load_scene(mapped("map.csv"))
    assert scene.skin.top.map.values == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert parse_scene(scene_text(scene), "kept") == scene, "without the file"


@pytest.mark.parametrize("mode", ["L", "RGB", "I;16"])
def test_a_picture_is_read_upright_from_dark_to_light(mapped, tmp_path, mode):
    if mode == "I;16":
        seen = Image.fromarray(np.array([[0, 65535], [13107, 52428]], dtype=np.uint16))
    else:
        seen = Image.fromarray(np.array([[0, 255], [51, 204]], dtype=np.uint8)).convert(mode)
    seen.save(tmp_path / "map.png")
    scene = load_scene(mapped("map.png", "low = 0.5", "high = 1.5", part="foam"))
    expected = [[0.7, 1.3], [0.5, 1.5]]
    np.testing.assert_allclose(scene.skin.foam.map.values, expected, rtol=1e-12)


def test_large_pictures_are_reduced_to_means_on_request(mapped, tmp_path):
    values = np.arange(300 * 200).reshape(200, 300) % 251
    Image.fromarray(values.astype(np.uint8)).save(tmp_path / "map.png")
    with pytest.raises(InputError, match="200 rows of 300 values; at most 128 .* `rows` and"):
        load_scene(mapped("map.png", "low = 1", "high = 2.0"))
    asked = mapped("map.png", "low = 1.0", "high = 2.0", "rows = 10", "columns = 15")
    found = np.array(load_scene(asked).skin.top.map.values)
    expected = 1 + values[::-1].reshape(10, 20, 15, 20).mean(axis=(1, 3)) / 255
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "content", "lines", "told"),
    [
        ("none.csv", None, [], "`skin.top.map.path` .*none.csv: no such file"),
        ("a.csv", "1,2\n3\n", [], "must be lines of equally many numbers"),
        ("a.csv", "1,-2\n", [], "line 1, column 2: all factors must be finite and > 0, got '-2'"),
        *(
            ("a.csv", f"1,1\n2,{cell}\n", [], f"line 2, column 2: all factors .* got '{cell}'")
            for cell in ("x", "1_0", "٣", "nan", "inf")
        ),
        ("a.csv", "1,2\n", ["low = 1.0"], "low and high are for pictures"),
        ("a.png", "no picture", ["low = 1.0", "high = 2.0"], "cannot be read as an image of PNG"),
        ("a.png", "", [], "low and high must be given"),
        ("a.png", "", ["low = 0.0", "high = 2.0"], "`low` must be from 1e-6 to 1e6"),
        ("a.csv", "1,2\n", ["rows = 129"], "`rows` must be <= 128, got 129"),
        ("a.csv", "1,2\n", ["colour = 1"], "`colour` is not a known key"),
    ],
)
def test_bad_files_are_refused_in_one_line(run, mapped, tmp_path, name, content, lines, told):
    if content is not None:
        (tmp_path / name).write_text(content, encoding="utf-8")
    scene = mapped(name, *lines)
    code, _, err = run("sweep", scene, "-o", tmp_path / "out.csv")
    with pytest.raises(InputError, match=told):
        load_scene(scene)
    assert (code, err.count("\n")) == (2, 1)
    assert err.startswith(f"rcskin: {scene}: `skin.top.map")


@pytest.mark.parametrize("start", ["//", r"\\\\", r"/\\", r"\\/", "//?/UNC/"])
def test_a_scene_opens_no_file_on_another_computer(mapped, tmp_path, start):
    """Windows would log in there, for a file that a scene of somebody else names."""
    of_mesh = tmp_path / "mesh.toml"
    text = (BUILTIN / "sheet-3x3.toml").read_text()
    of_mesh.write_text(text.replace("[skin]", f'[skin]\nmesh = "{start}evil/share/it.msh"', 1))
    for scene in (mapped(f"{start}evil/share/map.csv"), of_mesh):
        with pytest.raises(InputError, match="names a file on another computer, .*: copy it"):
            load_scene(scene)


SQUARE = np.array([[0.0, 0.12, 0.12, 0.0], [0.0, 0.0, 0.12, 0.12]])
EMPTY = np.empty((2, 0), dtype=np.int64)


def surface(points):
    return MeshSurface(points, np.array([[0, 0], [1, 2], [2, 3]]), EMPTY, {}, {})


@pytest.mark.parametrize(
    ("factor", "hint"),
    [
        (1e3, "120 x 120 m .* a factor of 1000; .*did you mean mm"),
        (100, "did you mean cm"),
        (1 / 0.0254, "did you mean inches"),
        (1e-3, "did you mean km"),
        (20, "a factor of 20; points of a mesh are in m$"),
    ],
)
def test_a_mesh_in_another_unit_is_refused(factor, hint):
    with pytest.raises(ValueError, match=hint):
        check_extent(surface(factor * SQUARE), 0.12, 0.12)


@pytest.mark.parametrize(("shift", "warned"), [(0, False), (0.005, False), (-0.06, True)])
def test_a_mesh_off_the_grid_is_warned_of(shift, warned):
    moved = surface(SQUARE + shift)
    check_extent(moved, 0.12, 0.12)
    found = list(off_grid(moved, 0.12, 0.12))
    assert [bool(each) for each in found] == [True] * warned
    assert all("x = -60 to 60 mm" in each for each in found)
