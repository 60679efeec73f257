"""Pictures drawn off screen: not blank, and the field where it should be."""

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.image import imread
from rcskin.simulator.view.figure import compose, rendered
from rcskin.simulator.view.outputs import panels_of, rows_of_panels, title, write_output
from rcskin.simulator.view.painting import paint
from rcskin.simulator.view.quantities import chosen

pytestmark = pytest.mark.pictures


def only_panel(set_up, what):
    (quantity,) = chosen(what, set_up.fields)
    (panel,) = panels_of(set_up, quantity)
    return panel


def painted(set_up, what, pixels=300):
    panel = only_panel(set_up, what)
    return panel, paint(panel.scenery, panel.shown, panel.camera, pixels)


def colour_at(panel, image, x, y):
    """Where a place (x, y) in m of a flat skin is in the picture; 0 to 255."""
    low, high = panel.camera.low, panel.camera.high
    across, up = (np.array([x, y]) - low) / (high - low)
    height, width = image.shape[:2]
    return image[int((1 - up) * height), int(across * width)].astype(int)


def expected(name, share):
    return 255 * np.array(colormaps[name](share)[:3])


@pytest.mark.parametrize("corners", [3, 4])
def test_the_field_is_where_it_should_be(fields, stage, corners):
    skin = fields(frequencies=[1e6], corners=corners, n=(61, 17))
    panel, image = painted(stage(skin), "potential")
    V = np.abs(skin.potential[0, 0] - skin.potential[1, 0])
    for x in (0.003, 0.013, 0.113):
        at = np.argmin(np.abs(skin.x[0] - x))
        assert np.allclose(colour_at(panel, image, x, 0.007), expected("viridis", V[at]), atol=25)
    assert (colour_at(panel, image, -0.001, 0.04) == 255).all()


def test_signed_fields_are_white_where_they_change_sign(fields, stage):
    skin = fields(frequencies=[1e5], n=(121, 17))
    panel, image = painted(stage(skin), "sensitivity-Rs", 600)
    row = skin.by_rise_Rs[0, :121]
    at = np.flatnonzero(np.diff(np.sign(row)))[0]
    assert colour_at(panel, image, skin.x[0, at], 0.007).min() > 225
    signs = np.sign(row[[2, -3]])
    for x, sign in zip((0.003, 0.117), signs, strict=True):
        red, _, blue = colour_at(panel, image, x, 0.007)
        assert np.sign(red - blue) == sign


def test_phases_that_go_around_have_a_closed_map(fields, stage):
    panel = only_panel(stage(fields(frequencies=[3e6])), "phase")
    assert panel.shown.limits == (-180, 180) and panel.shown.colours == "twilight"
    assert len(panel.shown.contours) > 0
    near = only_panel(stage(fields(frequencies=[1e4])), "phase")
    assert near.shown.colours == "viridis" and near.shown.limits[1] == pytest.approx(0, abs=1e-9)


def test_lines_of_equal_phase_are_where_the_phase_is(fields, stage):
    skin = fields(frequencies=[3e6], n=(241, 3))
    panel = only_panel(stage(skin), "phase")
    degrees = np.degrees(np.angle(skin.potential[0, 0, :241]))
    step = float(panel.shown.note.removeprefix("a line every ").removesuffix("°"))
    for line in panel.shown.contours:
        angle = np.interp(line[0].mean(), skin.x[0, :241], np.unwrap(degrees, period=360))
        assert abs(angle / step - round(angle / step)) < 0.15


def test_the_pressed_place_is_outlined_black_in_white(fields, stage):
    skin = fields(frequencies=[1e4])
    for press, outlined in (("3,5", True), ("none", False)):
        panel, image = painted(stage(skin, press=press), "potential", 900)
        along = [colour_at(panel, image, x, 0.05) for x in np.linspace(0.098, 0.102, 41)]
        assert (np.min(np.max(along, axis=1)) < 20) == outlined
        assert (np.max(np.min(along, axis=1)) > 200) == outlined


def test_deformation_is_seen_from_the_side_with_its_foam(fields, stage):
    foam = {"thickness": 4e-3, "relative_permittivity": 2.2}
    set_up = stage(fields(depth=1.5e-3), foam=foam)
    panel, image = painted(set_up, "deformation")
    assert panel.shown.note == "heights drawn 5 times"
    assert not panel.camera.above and len(panel.scenery.bodies) == 1
    assert panel.scenery.bodies[0].bounds[4] == pytest.approx(-5 * 4e-3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_wrapped_skin_lies_on_its_mug(fields, stage, axis):
    shape = {"kind": "cylinder", "radius": 0.04, "axis": axis}
    x, position = fields().x, stage(fields(), shape=shape).parts.skin.shape.position
    given = fields(frequencies=[1e4], n=(49, 33))
    wrapped = type(given)(**{**vars(given), "position": position(given.x, (0.12, 0.08))})
    panel, image = painted(stage(wrapped, shape=shape), "current")
    (mug,) = panel.scenery.bodies
    bent, kept = (0, 1) if axis == "y" else (1, 0)
    foils = panel.scenery.marks.foils
    rising = np.hypot(foils[0].quads[bent] - np.ptp(x[bent]) / 2, foils[0].quads[2] + 0.04)
    assert rising == pytest.approx(0.04, rel=1e-6)
    radii = np.hypot(mug.points[:, bent] - np.ptp(x[bent]) / 2, mug.points[:, 2] + 0.04)
    assert radii == pytest.approx(0.985 * 0.04, rel=2e-3)
    assert np.ptp(mug.points[:, kept]) > np.ptp(x[kept])
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100
    flat = only_panel(stage(wrapped, shape=shape, wrapped=False), "current")
    assert flat.camera.above and not flat.scenery.bodies


@pytest.mark.parametrize("exaggeration", [None, 1.0, 5.0])
def test_a_press_on_a_mug_is_seen(fields, stage, exaggeration):
    """The dent has the colour of its depth, not that of the mug."""
    given = fields(depth=2e-3, radius=0.04, n=(97, 65))
    shape = {"kind": "cylinder", "radius": 0.04}
    foam = {"thickness": 4e-3, "relative_permittivity": 2.2}
    set_up = stage(given, press="3,5", shape=shape, foam=foam, exaggeration=exaggeration)
    panel, image = painted(set_up, "deformation", 600)
    skin = panel.scenery.skin
    mug = panel.scenery.bodies[-1]
    from_axis = np.hypot(skin.points[0] - 0.06, skin.points[2] + 0.04)
    assert np.hypot(mug.points[:, 0] - 0.06, mug.points[:, 2] + 0.04).max() < from_axis.min()
    at = np.argmin(np.hypot(given.x[0] - 0.087, given.x[1] - 0.043))
    x, y = panel.camera.project(skin.points[:, at])
    share = given.deflection[at] / given.deflection.max()
    assert np.allclose(colour_at(panel, image, x, y), expected("viridis", share), atol=60)


def test_nothing_drawn_is_outside_of_the_picture(fields, stage):
    for set_up in (stage(fields([1e4])), stage(fields([1e4], depth=2e-3))):
        for quantity in chosen("all", set_up.fields):
            panel = panels_of(set_up, quantity)[0]
            quads = [foil.quads.reshape(3, -1) for foil in panel.scenery.marks.foils]
            seen = panel.camera.project(np.hstack([panel.scenery.skin.points, *quads]))
            assert (seen.T >= panel.camera.low).all() and (seen.T <= panel.camera.high).all()


def test_a_picture_of_everything_is_written(fields, stage, tmp_path):
    path = tmp_path / "all.png"
    write_output(path, stage(fields(frequencies=[1e4], depth=1e-3)), "all", None)
    image = imread(path)[..., :3]
    assert image.shape[1] > 1500 and image.shape[0] > 1000
    assert len(np.unique((255 * image).astype(np.uint8).reshape(-1, 3), axis=0)) > 1000
    assert list(tmp_path.iterdir()) == [path]


def drawn(rows, heading="title"):
    """A figure of panels, laid out."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 6), layout="constrained")
    canvas = FigureCanvasAgg(figure)
    compose(figure, rows, heading)
    canvas.draw()
    return figure


def test_rows_and_columns_are_numbered_where_their_pixels_are(fields, stage):
    axes = drawn([[only_panel(stage(fields([1e4])), "potential")]]).axes[0]
    above, beside = [each for each in axes.child_axes if not each.get_images()][:2]
    assert [tick.get_text() for tick in above.get_xticklabels()] == list("123456")
    assert above.get_xticks() == pytest.approx([10, 30, 50, 70, 90, 110])
    assert [tick.get_text() for tick in beside.get_yticklabels()] == list("1234")
    assert beside.get_yticks() == pytest.approx([10, 30, 50, 70])
    assert (above.get_xlabel(), beside.get_ylabel()) == ("column", "row")


def test_pixels_of_a_tilted_skin_are_named_by_row_and_column(fields, stage):
    panel = only_panel(stage(fields(depth=2e-3)), "deformation")
    named = {text.get_text(): text.get_position() for text in drawn([[panel]]).axes[0].texts}
    middle = panel.camera.project(np.array([0.09, 0.01, 0.0]))
    assert named["1,5"] == pytest.approx(tuple(1e3 * middle), abs=1.0)
    rows, columns = panel.scenery.marks.middles.shape[1:]
    every = {f"{i},{j}" for i in range(1, rows + 1) for j in range(1, columns + 1)}
    edge_on = every - set(named)
    assert edge_on <= {"2,5"}, "all but where the slope of the dent hides its pixel"


def test_every_picture_names_the_foils_in_colours_of_their_own(fields, stage):
    figure = drawn(rows_of_panels(stage(fields([1e4, 1e5])), "power"))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "top-left (high)",
        "bottom-left (low)",
    ]
    assert all(text.get_fontsize() >= 9 for text in legend.get_texts())
    colours = {patch.get_facecolor() for patch in legend.get_patches()}
    assert len(colours) == 2


def test_axes_stand_beside_the_foils(fields, stage):
    axes = drawn([[only_panel(stage(fields([1e4])), "potential")]]).axes[0]
    left, _, bottom, _ = axes.get_images()[0].get_extent()
    assert -12 < left < -7 and -3 < bottom < 0
    assert axes.spines["left"].get_visible() and axes.spines["left"].get_bounds() == (0, 80)


def test_panels_of_a_movie_stay_where_they_are(fields, stage):
    shown = panels_of(stage(fields([1e3, 1e5])), chosen("phase", fields())[0])
    assert shown[0].shown.limits != shown[1].shown.limits
    places = [drawn([[panel]]).axes[0].get_position().bounds for panel in shown]
    assert places[0] == pytest.approx(places[1], abs=1e-9)


def test_frequencies_stand_side_by_side(fields, stage):
    rows = rows_of_panels(stage(fields()), "potential")
    assert [len(row) for row in rows] == [3]
    assert [panel.shown.moment.split(",")[0] for panel in rows[0]] == ["1 kHz", "10 kHz", "100 kHz"]


def test_the_title_states_scene_press_and_interface(fields, stage):
    assert title(stage(fields())) == "scene, press 3,5:2, interface meter"
    assert title(stage(fields(), press="none")) == "scene, unpressed, interface meter"


def test_movies_get_pictures_of_even_sides(fields, stage):
    set_up = stage(fields(frequencies=[1e4]))
    image = rendered(rows_of_panels(set_up, "potential"), title(set_up), 61)
    assert image.shape[0] % 2 == image.shape[1] % 2 == 0


def test_movies_keep_the_lines_between_pixels():
    """Those are half transparent: a palette without what they make of the colours breaks them."""
    from matplotlib import colormaps
    from rcskin.simulator.view.outputs import _palette
    from rcskin.simulator.view.painting import under_grid

    palette = _palette(["viridis"]).astype(float)
    lines = 255 * under_grid(colormaps["viridis"](np.linspace(0, 1, 500))[:, :3])
    off = np.linalg.norm(lines[:, None] - palette, axis=2).min(axis=1)
    assert off.max() < 4
