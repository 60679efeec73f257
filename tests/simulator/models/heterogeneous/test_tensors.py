"""Symmetric tensors in three numbers, against matrices."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.models.heterogeneous.materials import adjugate, between, directed, root

ENTRIES = st.lists(st.floats(-2, 2), min_size=4, max_size=4)


def matrix(tensor):
    xx, yy, xy = tensor
    return np.array([[xx, xy], [xy, yy]])


def positive(entries):
    """A positive definite tensor."""
    F = np.reshape(entries, (2, 2))
    G = F.T @ F + 0.1 * np.eye(2)
    return np.array([G[0, 0], G[1, 1], G[0, 1]])


@given(ENTRIES)
def test_the_root_squared_is_the_tensor(entries):
    G = positive(entries)
    U = matrix(root(G, np.sqrt(np.linalg.det(matrix(G)))))
    np.testing.assert_allclose(U @ U, matrix(G), rtol=1e-12, atol=1e-12)
    assert (np.linalg.eigvalsh(U) > 0).all()


@given(ENTRIES, ENTRIES)
def test_products_are_those_of_matrices(first, second):
    B, A = positive(first), positive(second)
    expected = matrix(B) @ matrix(A) @ matrix(B)
    np.testing.assert_allclose(matrix(between(B, A)), expected, rtol=1e-11, atol=1e-11)
    determinant = np.linalg.det(matrix(A))
    np.testing.assert_allclose(
        matrix(adjugate(A)) @ matrix(A), determinant * np.eye(2), rtol=1e-11, atol=1e-11
    )


@given(st.floats(0.01, 100), st.floats(-7, 7))
def test_a_directed_tensor_has_its_ratio_along_its_angle_and_determinant_one(ratio, angle):
    A = matrix(directed(ratio, angle))
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-np.sin(angle), np.cos(angle)])
    np.testing.assert_allclose(np.linalg.det(A), 1, rtol=1e-9)
    np.testing.assert_allclose(A @ along, np.sqrt(ratio) * along, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(along @ A @ along / (across @ A @ across), ratio, rtol=1e-9)
