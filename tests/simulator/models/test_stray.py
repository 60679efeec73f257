"""Sizes of what two sheets alone leave out, against closed forms and three-dimensional solves."""

import numpy as np
import pytest
from rcskin.simulator.models import stray
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.walls import step_capacitance
from rcskin.simulator.scene.extent import perimeter, surface
from rcskin.simulator.scene.foam.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.scene.surroundings import Body

OUTLINE = {
    "skin.outline": {"circle": [0.06, 0.06, 0.05], "holes": [{"circle": [0.06, 0.06, 0.02]}]},
    "contact.1.edge": "outline",
    "contact.2.edge": "outline",
}


@pytest.mark.parametrize(
    ("sides", "thickness", "solved", "within"),
    [((0.12, 0.12), 4e-3, 0.918, 0.01), ((0.1, 0.02), 4e-3, 0.751, 0.05)],
)
def test_the_rim_is_that_of_a_solve_in_three_dimensions(sides, thickness, solved, within):
    gamma = stray.rim_per_length(*sides, thickness) / VACUUM_PERMITTIVITY
    assert gamma == pytest.approx(solved, rel=within)


def test_the_rim_of_wide_plates_is_kirchhoffs():
    """d/(2 pi) (1 + ln 2 pi w/d) beyond the edge of a plate whose other side is far."""
    width, d = 1.0, 1e-5
    gamma = stray.rim_per_length(1e6, width, d) / VACUUM_PERMITTIVITY
    assert gamma == pytest.approx((1 + np.log(2 * np.pi * width / d)) / (2 * np.pi), rel=1e-6)


def test_the_share_of_the_rim_is_that_of_the_paper_sheet():
    scene = load_scene("sheet-5x5").with_({"skin.foam.thickness": 4e-3})
    assert stray.rim_share(scene) == pytest.approx(0.056, abs=5e-4)
    gamma = stray.rim_per_length(0.12, 0.12, 4e-3)
    assert stray.rim_share(scene) == pytest.approx(2 * gamma / 4.861e-9 * (2 / 0.12))


def test_the_walls_of_a_press_are_those_of_a_solve_in_three_dimensions():
    """2 mm into 4 mm over 24 x 24 mm: 17 %; a step from 4 to 2 mm has 0.2498 eps a metre."""
    scene = load_scene("sheet-5x5").with_({"skin.foam.thickness": 4e-3})
    assert step_capacitance(0.5) == pytest.approx(0.2498, abs=1e-4)
    assert stray.wall_share(scene, 2.0) == pytest.approx(0.17, abs=5e-3)


def test_a_hole_has_a_rim_too():
    skin = load_scene("sheet-3x3").with_(OUTLINE).skin
    assert perimeter(skin) == pytest.approx(2 * np.pi * 0.07)
    assert surface(skin) == pytest.approx(np.pi * (0.05**2 - 0.02**2))


@pytest.mark.parametrize(("sides", "within"), [((1, 1), 0.025), ((5, 1), 0.025), ((20, 1), 0.08)])
def test_a_plate_in_space_has_the_capacitance_of_its_moments(sides, within):
    assert stray.plate_capacitance(*sides) / VACUUM_PERMITTIVITY == pytest.approx(
        _moments(*sides), rel=within
    )


def test_a_square_plate_is_the_known_one():
    known = 0.36679 * 4 * np.pi * VACUUM_PERMITTIVITY
    assert stray.plate_capacitance(1.0, 1.0) == pytest.approx(known, rel=0.025)


def _moments(length, width, cells=24):
    """Capacitance over eps0 by constant charges on cells that are narrower towards the edges."""
    x, y = (side * (1 - np.cos(np.linspace(0, np.pi, cells + 1))) / 2 for side in (length, width))
    at = np.stack(np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2), -1).reshape(-1, 2)
    low = np.stack(np.meshgrid(x[:-1], y[:-1]), -1).reshape(-1, 2)
    high = np.stack(np.meshgrid(x[1:], y[1:]), -1).reshape(-1, 2)

    def potential(u, v):
        return u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))

    (a, c), (b, d) = (np.moveaxis(end - at[:, None], -1, 0) for end in (low, high))
    of_cells = potential(b, d) - potential(a, d) - potential(b, c) + potential(a, c)
    charge = np.linalg.solve(of_cells / (4 * np.pi), np.ones(len(at)))
    return float(charge @ (high - low).prod(axis=1))


@pytest.mark.parametrize(
    ("name", "solved", "within"), [("sheet-5x5", 0.228, 0.1), ("strip-1x5", 0.31, 0.2)]
)
def test_a_body_raises_Rs_about_as_in_a_solve_in_three_dimensions(name, solved, within):
    assert stray.body_share(load_scene(name)) == pytest.approx(solved, rel=within)


def test_a_body_far_off_is_earth_with_nothing_near():
    scene = load_scene("sheet-5x5")
    far = stray.body_share(scene, Body(distance=1e3))
    assert far == pytest.approx(stray.open_share(scene), rel=1e-4)


def test_a_finger_at_the_far_end_is_the_paper_sheets():
    """In column 5 of 5, 12 mm from the end: 5.62 % by dRs = R C_f c (L x - x²/2) / C²."""
    share = stray.finger_share(load_scene("sheet-5x5"), 5.3e-12)
    assert share * (1 - 0.1**2) == pytest.approx(0.0562, abs=2e-4)


def test_foils_that_overlap_shorten_the_line():
    """Rs of a line as short as what they leave, its capacitance with the foils' counted."""
    strip = load_scene("strip-1x5").with_({"pixels.columns": 1})
    width, low = 5e-3, np.array([1e-1])
    short = strip.with_({"skin.length": strip.skin.length - width})
    R, shorter = (Line(each).impedance(Press(), low).real[0, 0] for each in (strip, short))
    part = short.skin.length / strip.skin.length
    fall = stray.overlap_share(strip.skin.length, width)
    assert 1 - shorter / R * part**2 == pytest.approx(fall, rel=1e-6)
