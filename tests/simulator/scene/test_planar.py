"""Areas that a disc and rectangles share with the cells of a grid."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.scene.planar import disc_fraction, shared

INSIDE = st.lists(st.integers(-1500, 1500), max_size=6, unique=True)
LINES = INSIDE.map(lambda at: np.array([-2000, *sorted(at), 2000]) / 1000)


@given(columns=LINES, rows=LINES)
def test_parts_of_a_disc_add_up_to_it(columns, rows):
    areas = np.multiply.outer(np.diff(rows), np.diff(columns))
    fraction = disc_fraction(0.3, -0.2, 0.7, columns, rows)
    np.testing.assert_allclose((areas * fraction).sum(), np.pi * 0.49, rtol=1e-12)


def test_a_quarter_and_a_segment_of_a_disc():
    """The part beyond half the radius is r² (pi / 3 - sqrt(3) / 4)."""
    quarter = disc_fraction(1.0, 2.0, 3.0, np.array([1.0, 4.0]), np.array([2.0, 5.0]))
    np.testing.assert_allclose(quarter, np.pi / 4, rtol=1e-14)
    segment = disc_fraction(0.0, 0.0, 1.0, np.array([0.5, 1.0]), np.array([-1.0, 1.0]))
    np.testing.assert_allclose(segment, np.pi / 3 - np.sqrt(3) / 4, rtol=1e-14)


def test_cells_against_counted_points():
    columns, rows = np.linspace(0, 1, 6), np.linspace(0, 1, 5)
    x, y = np.meshgrid((np.arange(2000) + 0.5) / 2000, (np.arange(2000) + 0.5) / 2000)
    inside = np.hypot(x - 0.4, y - 0.55) < 0.33
    counted = inside.reshape(4, 500, 5, 400).mean(axis=(1, 3))
    fraction = disc_fraction(0.4, 0.55, 0.33, columns, rows)
    np.testing.assert_allclose(fraction, counted, atol=1e-3)


@given(spans=LINES, cells=LINES)
def test_every_interval_is_shared_out(spans, cells):
    np.testing.assert_allclose(shared(spans, cells).sum(axis=0), 1.0, rtol=1e-12)
