"""Lengths that intervals share with others."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.scene.planar import shared

INSIDE = st.lists(st.integers(-1500, 1500), max_size=6, unique=True)
LINES = INSIDE.map(lambda at: np.array([-2000, *sorted(at), 2000]) / 1000)


@given(spans=LINES, cells=LINES)
def test_every_interval_is_shared_out(spans, cells):
    np.testing.assert_allclose(shared(spans, cells).sum(axis=0), 1.0, rtol=1e-12)
