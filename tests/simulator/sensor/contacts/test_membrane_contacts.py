"""Contacts on skins with tension, against the membrane on triangles."""

import numpy as np
import pytest
from rcskin import PointContacts, PressureImage, load
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.models.mechanics.lattice_presses import traced
from rcskin.simulator.models.mechanics.relaxation_kernel import Bodies
from rcskin.simulator.press.press import press_on
from rcskin.simulator.sensor.contacts.patch_kernel import FORCE
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer
from rcskin.simulator.sensor.contacts.spread_contacts import radial_table

GRID = 12, 12


@pytest.fixture(scope="module")
def rasterizer():
    scene = load("foam")
    return ContactRasterizer.of(scene.parts.skin, scene.press, GRID)


def on_lattice(rasterizer, contacts):
    return rasterizer.spread.on_lattice(contacts.values[0], FORCE)


def dense(touched):
    rises = np.zeros(GRID[0] * GRID[1])
    rises[touched.cells] = touched.rises
    return rises


def test_the_table_of_a_disc_has_the_depths_of_the_membrane(rasterizer):
    skin, pressing = rasterizer.skin, rasterizer.pressing
    table = radial_table(rasterizer.spread.lattice(np.inf), 5e-3, np.inf)
    for force in (0.1, 4.0):
        press = press_on(skin, pressing, f"disc(0.06,0.06,0.005):{force}N")
        (depth,) = deformation(skin, press, 1e-3).depth
        assert np.interp(force, table.force, table.depth) == pytest.approx(depth, rel=2e-3)


def test_a_disc_alone_presses_cells_as_the_membrane_does(rasterizer):
    x, y, r, depth = 0.053, 0.061, 0.005, 0.002
    applied = Bodies.by_depth(
        np.array([[x - r, x + r, y - r, y + r]]), np.array([r]), np.array([depth])
    )
    exact = dense(traced(rasterizer.skin, rasterizer.spread.lattice(2 * r), applied))
    found = rasterizer(PointContacts(x, y, radius=r, depth=depth)).batch.one(0)
    assert np.abs(dense(found) - exact).max() <= 3e-3 * exact.max()
    assert dense(found).sum() == pytest.approx(exact.sum(), rel=1e-3)


@pytest.mark.parametrize(
    "end",
    [
        {"radius": 5e-3},
        {"curvature_radius": 0.02},
        {"radius": 4e-3, "curvature_radius": 0.01},
    ],
)
@pytest.mark.parametrize("force", [0.05, 0.6])
def test_lattice_and_table_agree(rasterizer, end, force):
    contacts = PointContacts(0.053, 0.061, force, **end)
    table = rasterizer(contacts).batch.one(0)
    lattice = on_lattice(rasterizer, contacts).touched
    assert np.abs(dense(table) - dense(lattice)).max() <= 1e-2 * dense(lattice).max()


@pytest.mark.parametrize(
    ("text", "contacts"),
    [
        ("disc(0.011,0.06,0.01):3N", PointContacts(0.011, 0.06, 3.0, 0.01)),
        ("rect(0.05,0.06,0.01,0.02):2N", PointContacts(0.05, 0.06, 2.0, size=(0.01, 0.02))),
        pytest.param(
            "disc(0.05,0.06,0.005):1N+disc(0.062,0.06,0.005):2N",
            PointContacts([0.05, 0.062], 0.06, [1.0, 2.0], 5e-3),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_near_edges_and_neighbours_the_depths_are_those_of_the_membrane(rasterizer, text, contacts):
    exact = deformation(
        rasterizer.skin,
        press_on(rasterizer.skin, rasterizer.pressing, text),
        1e-3,
    ).depth
    found = on_lattice(rasterizer, contacts)
    np.testing.assert_allclose(found.depth, exact, rtol=3e-3)
    np.testing.assert_array_equal(rasterizer(contacts).batch.cells, found.touched.cells)


def test_a_uniform_pressure_strains_all_foam_by_the_law(rasterizer):
    pressure = 1e3
    batch = rasterizer(PressureImage(np.full((3, 5), pressure))).batch
    strain = rasterizer.foam.strains_under(np.array(pressure))
    rise = rasterizer.skin.foam.factor_at(strain) - 1
    np.testing.assert_allclose(batch.rises, np.full(GRID[0] * GRID[1], rise), rtol=1e-3)
