"""pyMOR's own reduced basis: its weak greedy search by its residual estimator, its projection.

Asked of it is w in (K + s M) w = M g, M = sum c_k M_k over the pixels, from the same matrices as
this project reduces; then Y = s g'Mg - s² (Mg)'w, which the square of the error of w enters.
pyMOR: R. Milk, S. Rave, F. Schindler, SIAM J. Sci. Comput. 38 (2016) S194; https://pymor.org
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.exceptions import ComplexWarning
from numpy.typing import NDArray
from pymor.algorithms.greedy import rb_greedy
from pymor.core.logger import set_log_levels
from pymor.models.basic import StationaryModel
from pymor.models.iosys import LTIModel
from pymor.operators.constructions import LincombOperator, VectorFunctional, VectorOperator
from pymor.operators.numpy import NumpyMatrixOperator
from pymor.parameters.functionals import ProductParameterFunctional, ProjectionParameterFunctional
from pymor.reductors.basic import LTIPGReductor
from pymor.reductors.coercive import CoerciveRBReductor
from rcskin.simulator.models.reduced.family import Family
from scipy.sparse import csc_matrix

MOST_VECTORS = 200


@dataclass(frozen=True)
class Matrices:
    """Of the inner unknowns of one drive at rest.

    K: S. masses: M_k of each pixel, F. charges: M_k g, F V, shape (pixel, inner). at_once: g'M_k g,
    F V², shape (pixel,).
    """

    K: csc_matrix
    masses: tuple[csc_matrix, ...]
    charges: NDArray[np.float64]
    at_once: NDArray[np.float64]

    @classmethod
    def of_family(cls, family: Family) -> Matrices:
        """For the first drive of a family in which no terminal floats."""
        space = family.space
        potential = space.driven(family.circuit.excitations[0]).potential
        alone = np.eye(family.skin.pixels.rows * family.skin.pixels.columns)
        whole = [space.restricted(family.mass(pixel)) for pixel in alone]
        charges = np.array([mass @ potential for mass in whole])
        inner = [mass[: space.inner][:, : space.inner] for mass in whole]
        for mass in inner:
            mass.eliminate_zeros()
        return cls(space.K, tuple(inner), charges[:, : space.inner], charges @ potential)


class Basis:
    """A basis that pyMOR found, and its reduced model."""

    def __init__(
        self,
        matrices: Matrices,
        training: Iterable[tuple[complex, NDArray[np.float64]]],
        rtol: float,
    ) -> None:
        """training: s in rad/s, and c of each pixel over that at rest. rtol: estimated, of w.

        The estimate is a bound: with Re s >= 0 the operator is coercive in K with constant 1.
        pyMOR solves real systems by complex factors it has kept, and numpy warns of what is zero.
        """
        set_log_levels({"pymor": "ERROR"})
        self._at_once = matrices.at_once
        terms = _Terms(matrices)
        model, K = terms.stationary(), terms.K
        reductor = CoerciveRBReductor(model, product=K)
        parameters = [model.parameters.parse({"s": [s], "c": c}) for s, c in training]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ComplexWarning)
            rb_greedy(model, reductor, parameters, rtol=rtol, max_extensions=MOST_VECTORS)
        vectors = reductor.bases["RB"]
        self.size = len(vectors)
        self._reduced = LTIPGReductor(terms.system(), vectors, vectors).reduce()

    def impedance(self, c: NDArray[np.float64], frequencies: NDArray) -> NDArray[np.complex128]:
        """Z in ohm of a press, shape (frequency,). c: of each pixel over that at rest."""
        omega = 2 * np.pi * np.asarray(frequencies)
        model = self._reduced
        at_press = model.parameters.parse({"c": c})
        parts = {name: getattr(model, name).assemble(at_press) for name in "ABCE"}
        delayed = model.with_(**parts).transfer_function.freq_resp(omega)[:, 0, 0]
        return 1 / (1j * omega * (c @ self._at_once) + omega**2 * delayed)


class _Terms:
    """The matrices as operators of pyMOR, with the parameters s and c that they come with."""

    def __init__(self, matrices: Matrices) -> None:
        pixels = len(matrices.masses)
        self._c = [ProjectionParameterFunctional("c", pixels, k) for k in range(pixels)]
        self.K = NumpyMatrixOperator(matrices.K)
        self._masses = [NumpyMatrixOperator(mass) for mass in matrices.masses]
        charges = [self.K.range.from_numpy(charge) for charge in matrices.charges]
        self._right = LincombOperator([VectorOperator(charge) for charge in charges], self._c)
        self._output = LincombOperator([VectorFunctional(charge) for charge in charges], self._c)

    def stationary(self) -> StationaryModel:
        """(K + s M) w = M g."""
        s = ProjectionParameterFunctional("s", 1, 0)
        factors = [1.0, *(ProductParameterFunctional([s, c]) for c in self._c)]
        return StationaryModel(
            LincombOperator([self.K, *self._masses], factors), self._right, self._output
        )

    def system(self) -> LTIModel:
        """The same as M w' + K w = M g."""
        return LTIModel(
            -self.K, self._right, self._output, E=LincombOperator(self._masses, self._c)
        )
