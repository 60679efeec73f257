"""Contacts on coarse cells keep amount, middle and spread of the rises."""

import numpy as np
import pytest
from rcskin import DepthImage, PointContacts
from rcskin.simulator.sensor.cell_spreading import PARTS
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer

COARSE = 6, 5
DENSE = 240, 250
CONTACTS = {
    "disc": PointContacts(0.053, 0.061, 1.0, 5e-3),
    "large disc": PointContacts(0.053, 0.061, 10.0, 0.03),
    "sphere": PointContacts(0.053, 0.061, 0.3, curvature_radius=0.02),
    "rectangle": PointContacts(0.053, 0.061, 2.0, size=(0.04, 0.01)),
    "depth": PointContacts(0.053, 0.061, depth=1e-3, radius=5e-3),
    "overlap": PointContacts([0.053, 0.056], [0.061, 0.06], [0.3, 0.2], 5e-3),
    "factors": PointContacts([0.053, 0.056], 0.061, radius=5e-3, factor=[2.0, 1.5]),
    "edge": PointContacts(0.055, 0.003, 1.0, 5e-3),
}


def moments(batch, grid, scene, degree):
    """Integrals of x^a y^b times the rise over the skin, a + b = degree; cells are uniform."""
    rises = np.zeros(grid)
    rises.ravel()[batch.cells] = batch.rises
    each = [np.polynomial.Polynomial([0] * k + [1]).integ() for k in range(degree + 1)]
    y, x = (
        np.linspace(0, side, n + 1) for side, n in zip(scene.skin.sides[::-1], grid, strict=True)
    )
    return [np.diff(each[degree - k](y)) @ rises @ np.diff(each[k](x)) for k in range(degree + 1)]


@pytest.mark.parametrize("name", CONTACTS)
def test_moments_are_kept(sharp, name):
    dense = ContactRasterizer.of(sharp.parts.skin, sharp.press, DENSE)(CONTACTS[name]).batch
    fine = PARTS * COARSE[0], PARTS * COARSE[1]
    coarse = ContactRasterizer.of(sharp.parts.skin, sharp.press, fine, coarse=COARSE)(
        CONTACTS[name]
    ).batch
    for degree in range(2 if name == "edge" else 3):
        np.testing.assert_allclose(
            moments(coarse, COARSE, sharp, degree),
            moments(dense, DENSE, sharp, degree),
            rtol={"edge": 1e-2, "overlap": 4e-3, "factors": 4e-3}.get(name, 4e-4),
        )


def test_moments_of_an_image_are_kept(sharp):
    depth = np.zeros((12, 16))
    depth[4:7, 5:9] = np.random.default_rng(1).uniform(0, 2e-3, (3, 4))
    image, fine = DepthImage(depth), (PARTS * COARSE[0], PARTS * COARSE[1])
    dense = ContactRasterizer.of(sharp.parts.skin, sharp.press, DENSE)(image).batch
    coarse = ContactRasterizer.of(sharp.parts.skin, sharp.press, fine, coarse=COARSE)(image).batch
    for degree in range(3):
        np.testing.assert_allclose(
            moments(coarse, COARSE, sharp, degree), moments(dense, DENSE, sharp, degree), rtol=1e-4
        )


def test_lattices_are_spread_as_fine_cells(sharp):
    spreading = sharp.with_({"skin.foam.mechanics.tension": 20.0})
    fine = PARTS * COARSE[0], PARTS * COARSE[1]
    on_fine = ContactRasterizer.of(spreading.parts.skin, spreading.press, fine)
    on_coarse = ContactRasterizer.of(spreading.parts.skin, spreading.press, fine, coarse=COARSE)
    for contacts in (CONTACTS["rectangle"], CONTACTS["edge"], CONTACTS["overlap"]):
        expected = on_coarse.spreading(on_fine(contacts).batch)
        found = on_coarse(contacts).batch
        np.testing.assert_array_equal(found.cells, expected.cells)
        np.testing.assert_allclose(found.rises, expected.rises)
