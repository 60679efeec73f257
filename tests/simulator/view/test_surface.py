"""The skin in space: its edge, ways off it, deflection, and lines that follow it."""

import numpy as np
import pytest
from rcskin.simulator.view.foils import foils
from rcskin.simulator.view.marks import arrows, marks
from rcskin.simulator.view.painting import lifted
from rcskin.simulator.view.skin_surface import is_curved, readable_exaggeration, surface


@pytest.mark.parametrize("corners", [3, 4])
@pytest.mark.parametrize("apart", [False, True])
def test_the_rim_goes_around_once(fields, corners, apart):
    skin = surface(fields(corners=corners, apart=apart))
    ends = skin.points[:, skin.rim]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0).sum() == pytest.approx(0.4)
    assert np.allclose(skin.normals, [[0], [0], [1]])


def test_deflection_goes_down_exaggerated(fields):
    given = fields(depth=1e-3)
    skin = surface(given, exaggeration=5.0)
    assert skin.points[2] == pytest.approx(-5 * given.deflection)


def test_a_wrapped_skin_is_pressed_towards_its_mug(fields):
    given = fields(depth=1e-3, radius=0.04, n=(97, 33))
    skin = surface(given, wrapped=True, exaggeration=3.0)
    from_axis = np.hypot(skin.points[0] - 0.06, skin.points[2] + 0.04)
    assert from_axis == pytest.approx(0.04 - 3 * given.deflection, abs=2e-5)


@pytest.mark.parametrize(("depth", "times"), [(1.5e-3, 5.0), (0.4e-3, 20.0), (0.05, 1.0)])
def test_exaggeration_is_a_round_number(fields, depth, times):
    assert readable_exaggeration(fields(depth=depth)) == times


def test_wrapped_skins_are_distinguished_from_flat_ones(fields):
    assert is_curved(fields(radius=0.04)) and not is_curved(fields())


def test_foils_lie_off_the_edge_the_bottom_sheets_farther(fields, stage):
    set_up = stage(fields())
    skin = surface(set_up.fields)
    top, bottom = foils(set_up.parts.skin, set_up.interface, skin, set_up.to_space)
    assert (top.name, top.role) == ("top-left", "high")
    assert (bottom.name, bottom.role) == ("bottom-left", "low")
    assert bottom.quads[0].max() < top.quads[0].min() < top.quads[0].max() < 0
    assert (top.quads[1].min(), top.quads[1].max()) == pytest.approx((0.0, 0.08))


def test_lines_follow_the_mug(fields, stage):
    set_up = stage(fields(radius=0.04, n=(97, 33)))
    skin = surface(set_up.fields, wrapped=True)
    drawn = marks(set_up.parts.skin, set_up.press, set_up.interface, skin, set_up.to_space)
    (pressed,) = [np.hstack(drawn.pressed)]
    assert np.hypot(pressed[0] - 0.06, pressed[2] + 0.04) == pytest.approx(0.04, abs=2e-5)
    assert (pressed[1].min(), pressed[1].max()) == pytest.approx((0.04, 0.06))
    assert len(drawn.pixels) == 3 + 5


@pytest.mark.parametrize(
    ("press", "around"),
    [
        ("rect(0.06,0.04,0.02,0.01)", 0.06),
        ("disc(0.06,0.04,0.01)", 2 * np.pi * 0.01),
        ("poly(0.02,0.02,0.05,0.02,0.02,0.06)", 0.12),
        ("1,1+4,6", 0.16),
    ],
)
def test_touches_are_outlined(fields, stage, press, around):
    set_up = stage(fields(), press)
    skin = surface(set_up.fields)
    drawn = marks(set_up.parts.skin, set_up.press, set_up.interface, skin, set_up.to_space)
    lengths = [np.linalg.norm(np.diff(line, axis=1), axis=0).sum() for line in drawn.pressed]
    assert sum(lengths) == pytest.approx(around, rel=1e-3)


def test_arrows_lie_along_the_skin_where_current_flows(fields):
    given = fields(radius=0.04, n=(97, 33))
    skin = surface(given, wrapped=True)
    flow = np.where(given.x[0] < 0.06, [[1.0], [0.0]], 0.0)
    drawn = arrows(skin, flow, 1.0)
    assert drawn.places[0].max() < 0.065
    assert np.linalg.norm(drawn.directions, axis=0) == pytest.approx(1)
    outwards = drawn.places - np.array([[0.06], [0], [-0.04]])
    outwards[1] = 0
    assert np.abs((drawn.directions * outwards).sum(axis=0)).max() < 1e-3 * 0.04


def test_nothing_stands_out_behind_the_edge_of_a_mug(fields, stage):
    """Lines are raised towards the eye, not sideways; arrows beyond the edge are left out."""
    given = fields(radius=0.04, n=(97, 33))
    set_up = stage(given)
    (panel,) = set_up.panels(set_up.plain_skin(), [None])
    skin, camera = panel.scenery.skin, panel.camera
    for line in panel.scenery.marks.rim:
        raised = lifted(line, skin, 1.5, camera.towards)
        assert camera.project(raised) == pytest.approx(camera.project(line), abs=1e-12)
        assert (camera.towards @ (raised - line) > 0).all()
    all_around = arrows(skin, np.ones_like(given.x) * [[1.0], [0.0]], 1.0)
    seen = all_around.facing(skin, camera.towards)
    assert 0 < seen.places.shape[1] < all_around.places.shape[1]
    assert (camera.towards @ skin.normals[:, skin.nearest(seen.places)] > 0).all()


CORNERS = [(0, 0), (0.06, 0), (0.12, 0), (0.12, 0.08), (0.06, 0.08), (0, 0.08)]


def strip_of_two_groups(path):
    """The skin of two groups of triangles, left and right, with boundary groups at both ends."""
    import meshio

    cells = {
        "triangle": [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]],
        "line": [[5, 0], [2, 3]],
    }
    named = {"a": ([0, 1], []), "b": ([2, 3], []), "feed": ([], [0]), "far": ([], [1])}
    sets = {name: [np.array(part, int) for part in parts] for name, parts in named.items()}
    points = np.array([(x, y, 0) for x, y in CORNERS], float)
    meshio.Mesh(points, list(cells.items()), cell_sets=sets).write(path)


def test_foils_and_pixels_of_a_mesh_lie_along_its_groups(fields, stage, tmp_path):
    path = tmp_path / "skin.inp"
    strip_of_two_groups(path)
    set_up = stage(fields(), press="1,2")
    tables = set_up.parts.scene.model_dump(by_alias=True, exclude_none=True)
    tables["skin"]["mesh"] = str(path)
    tables["pixels"] = {"rows": 1, "columns": 2, "groups": [["a", "b"]]}
    for contact, edge in zip(tables["contact"], ("feed", "far"), strict=True):
        contact["edge"] = edge
    scene = type(set_up.parts.scene).model_validate(tables)
    skin = surface(set_up.fields)
    drawn = marks(scene.parts.skin, set_up.press, scene.interfaces[0], skin, set_up.to_space)
    (between,) = drawn.pixels
    assert between[0] == pytest.approx(0.06)
    around = np.hstack(drawn.pressed)
    assert (around[0].min(), around[0].max()) == pytest.approx((0.06, 0.12))
    assert drawn.grid_lines is None
    assert drawn.middles[:, 0] == pytest.approx(np.array([[0.03, 0.09], [0.04, 0.04], [0, 0]]))
    high, low = drawn.foils
    assert high.quads[0].max() < 0 and low.quads[0].min() > 0.12


def test_a_line_around_a_dent_is_raised_alike_all_along_its_crease(fields):
    skin = surface(fields(depth=4e-3, n=(97, 33)), exaggeration=5.0)
    steep = np.argmin(skin.normals[2])
    along = skin.points[0, steep] + np.linspace(-0.004, 0.004, 60)
    line = np.array([along, np.full(60, skin.points[1, steep]), np.full(60, skin.points[2, steep])])
    ways = lifted(line, skin) - line
    turns = np.linalg.norm(np.diff(ways, axis=1), axis=0) / np.linalg.norm(ways[:, 0])
    single = skin.normals[:, skin.nearest(line)]
    assert turns.max() < np.linalg.norm(np.diff(single, axis=1), axis=0).max()
