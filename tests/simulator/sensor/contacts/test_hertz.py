"""A sphere on a Winkler foundation by closed forms, and the balance of its force."""

import numpy as np
import pytest
from rcskin import InputError, PointContacts, load
from rcskin.simulator.models.mechanics.foam_law import (
    energy,
    foam_tables,
    indenter_force,
    indenter_strain,
    rise_at,
    strain_under,
    stress,
)
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer, to_cells

GRID = 12, 12
CURVATURE = 0.02


@pytest.fixture(scope="module", params=["sharp", "linear"])
def either(request):
    return request.getfixturevalue(request.param)


def test_kernels_are_the_foam_s_law(either):
    elastic, tables = either.skin.foam.mechanics.elastic, foam_tables(either.skin.foam)
    for strain in (1e-3, 0.05, 0.3, 0.6):
        at = np.array(strain)
        assert stress(tables, strain) == pytest.approx(float(elastic.stress(at)), rel=1e-12)
        assert strain_under(tables, stress(tables, strain)) == pytest.approx(strain, rel=1e-5)
        rise = float(either.skin.foam.factor_at(at)) - 1
        assert rise_at(tables, strain) == pytest.approx(rise, rel=1e-5)
        assert energy(tables, strain) == pytest.approx(
            np.trapezoid(elastic.stress(s := np.linspace(0, strain, 20001)), s), rel=1e-7
        )


def test_the_force_of_a_sphere_on_linear_foam(linear):
    foam, tables = linear.skin.foam, foam_tables(linear.skin.foam)
    k, depth = foam.mechanics.young / foam.thickness, 1e-3
    force = indenter_force(tables, depth / foam.thickness, np.inf, CURVATURE)
    assert force == pytest.approx(np.pi * CURVATURE * k * depth**2, rel=1e-12)
    assert indenter_strain(tables, force, np.inf, CURVATURE) == pytest.approx(
        depth / foam.thickness, rel=1e-10
    )


def test_a_sphere_of_small_end_is_a_disc_and_of_large_end_a_sphere(either):
    tables = foam_tables(either.skin.foam)
    strain, small = 0.3, 1e-5
    flat = np.pi * small**2 * stress(tables, strain)
    assert indenter_force(tables, strain, small, CURVATURE) == pytest.approx(flat, rel=1e-4)
    whole = indenter_force(tables, strain, np.inf, CURVATURE)
    assert indenter_force(tables, strain, 0.1, CURVATURE) == whole


@pytest.mark.parametrize("place", [(0.05, 0.06), (0.004, 0.06), (0.003, 0.117)])
def test_the_foam_returns_the_whole_force(linear, place):
    """Linear foam of constant permittivity: rises follow strains, which add up to the force."""
    scene = linear.with_(
        {
            "skin.foam.mechanics.effective_medium": "constant",
            "skin.foam.mechanics.solid_permittivity": None,
            "skin.foam.relative_permittivity": 2.0,
        }
    )
    foam, force, grid = scene.skin.foam, 0.02, (240, 240)
    batch = to_cells(
        scene.parts.skin,
        scene.press,
        grid,
        PointContacts(*place, force, curvature_radius=CURVATURE),
    )
    strain = 1 - 1 / (1 + batch.rises)
    cell = scene.skin.length * scene.skin.width / (grid[0] * grid[1])
    assert (foam.mechanics.elastic.stress(strain) * cell).sum() == pytest.approx(force, rel=2e-3)


def test_cells_are_the_means_of_the_profile(sharp):
    x, y, force = 0.053, 0.061, 0.3
    tables, foam = foam_tables(sharp.skin.foam), sharp.skin.foam
    strain = indenter_strain(tables, force, np.inf, CURVATURE)
    n = 60
    at = (np.arange(GRID[0] * n) + 0.5) * sharp.skin.length / GRID[0] / n
    far = (at - x) ** 2 + (at[:, None] - y) ** 2
    profile = np.maximum(strain - far / (2 * CURVATURE * foam.thickness), 0.0)
    exact = (foam.factor_at(profile) - 1).reshape(GRID[0], n, GRID[1], n).mean(axis=(1, 3))
    found = np.zeros(GRID[0] * GRID[1])
    batch = to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts(x, y, force, curvature_radius=CURVATURE)
    )
    found[batch.cells] = batch.rises
    assert np.abs(found - exact.ravel()).max() < 1e-2 * exact.max()
    assert found.sum() == pytest.approx(exact.sum(), rel=2e-4)


def test_two_forces_on_one_place_are_their_sum(sharp):
    twice = to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts([0.05, 0.05], 0.06, [0.3, 0.2], 0.01)
    )
    once = to_cells(sharp.parts.skin, sharp.press, GRID, PointContacts(0.05, 0.06, 0.5, 0.01))
    assert twice.rises.sum() == pytest.approx(once.rises.sum(), rel=1e-2)
    assert twice.rises.max() == pytest.approx(once.rises.max(), rel=1e-2)


def test_of_two_depths_on_one_place_the_deeper_counts(sharp):
    twice = to_cells(
        sharp.parts.skin,
        sharp.press,
        GRID,
        PointContacts([0.05, 0.05], 0.06, radius=0.01, depth=[1e-3, 2e-3]),
    )
    once = to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts(0.05, 0.06, radius=0.01, depth=2e-3)
    )
    assert twice.rises.sum() == pytest.approx(once.rises.sum(), rel=1e-2)
    assert twice.rises.max() == pytest.approx(once.rises.max(), rel=1e-2)


def test_a_patch_that_hangs_over_the_edge_has_all_its_force_on_the_skin(sharp):
    half = to_cells(sharp.parts.skin, sharp.press, GRID, PointContacts(0.0, 0.06, 0.5, 0.01))
    whole = to_cells(sharp.parts.skin, sharp.press, GRID, PointContacts(0.05, 0.06, 1.0, 0.01))
    assert half.rises.sum() == pytest.approx(whole.rises.sum() / 2, rel=1e-6)


LAW = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}


def test_an_outline_cuts_patches():
    """Half a patch lies over a hole: the force presses the other half twice as much."""
    scene = load("l-shape").with_({"skin.foam": {"thickness": 4e-3, "mechanics": LAW}})
    rim = 0.03 + 0.012
    over = to_cells(scene.parts.skin, scene.press, (48, 48), PointContacts(rim, 0.03, 0.02, 2e-3))
    part = ContactRasterizer.of(scene.parts.skin, scene.press, (48, 48)).cells.part.ravel()[
        over.cells
    ]
    beside = to_cells(
        scene.parts.skin, scene.press, (48, 48), PointContacts(0.08, 0.02, 0.04, 2e-3)
    )
    assert (part < 1).any()
    assert (over.rises * part).sum() == pytest.approx(beside.rises.sum() / 2, rel=0.05)
    with pytest.raises(InputError, match="no skin of l-shape lies under the patch"):
        to_cells(scene.parts.skin, scene.press, (48, 48), PointContacts(0.03, 0.03, 0.02, 2e-3))
