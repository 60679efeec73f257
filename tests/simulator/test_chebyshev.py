"""A function through Chebyshev's extrema: exact for polynomials, refined for others, or refused."""

import numpy as np
import pytest
from rcskin.simulator.chebyshev import Interpolant, barycentric, extrema, refined


@pytest.mark.parametrize("count", [2, 5, 9])
def test_polynomials_of_a_lower_degree_than_nodes_are_exact(count):
    nodes, x = extrema(-0.5, 2.0, count), np.linspace(-0.5, 2.0, 12)
    powers = np.arange(count)
    found = Interpolant(nodes, nodes[:, None] ** powers)(x)
    np.testing.assert_allclose(found, x[:, None] ** powers, atol=1e-12)


def test_fewer_nodes_are_among_more_and_weights_there_are_none_but_their_own():
    nodes = extrema(0.3, 1.7, 9)
    np.testing.assert_array_equal(nodes[::2], extrema(0.3, 1.7, 5))
    np.testing.assert_array_equal(barycentric(nodes, nodes), np.eye(9))


def test_nodes_are_doubled_until_those_between_are_predicted_and_none_is_computed_twice():
    asked = []

    def values(x):
        asked.extend(x.tolist())
        return np.exp(x)

    def close(found, truth):
        return np.abs(found - truth).max() < 1e-4

    found = refined(values, (0.0, 3.0), (3, 33), close)
    assert found is not None and len(asked) == len(set(asked)) == len(found.nodes) == 17
    x = np.linspace(0.0, 3.0, 50)
    np.testing.assert_allclose(found(x), np.exp(x), atol=1e-4)
    assert refined(np.abs, (-1.0, 2.0), (3, 33), close) is None
