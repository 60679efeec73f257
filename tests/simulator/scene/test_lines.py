"""Nodes along one axis: on their lines, as narrow as asked, none much wider than its neighbour."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.mesh.quadrilaterals import nodes
from rcskin.simulator.scene.planar import distinct

LINES = st.lists(st.floats(1e-4, 1), min_size=1, max_size=5).map(lambda at: distinct([0.0, *at]))


@given(lines=LINES, cells=st.integers(1, 3), growth=st.sampled_from([2.0, 4.0, np.inf]))
def test_cells_grow_no_faster_than_required(lines, cells, growth):
    at = nodes(lines, cells, {}, growth)
    width = np.diff(at)
    assert (width > 0).all()
    assert np.isin(lines, at).all()
    assert (np.maximum(width[1:] / width[:-1], width[:-1] / width[1:]) <= growth * 1.001).all()
    assert len(at) >= cells * (len(lines) - 1) + 1


@given(lines=LINES, width=st.floats(1e-4, 1), which=st.integers(0, 5))
def test_cells_next_to_a_line_are_as_narrow_as_required(lines, width, which):
    line = lines[which % len(lines)]
    at = nodes(lines, 1, {float(line): width})
    beside = np.flatnonzero(at == line)[0]
    assert (np.diff(at)[max(beside - 1, 0) : beside + 1] <= width * 1.001).all()
