"""Features and targets of sweeps, as a result for scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .samples import Samples


class Features(tuple["NDArray[Any]", "NDArray[Any]"]):
    """The features X and the targets y of sweeps; unpacks into these two arrays.

    X: shape (sweep, feature). y: shape (sweep,), for positions (sweep, 3). index: numbers of these
    sweeps among the given ones, from 0, ascending, shape (sweep,). left_out: text on the sweeps
    that were left out, with the reasons.
    """

    index: NDArray[Any]
    left_out: str
    _about: str

    @classmethod
    def of(cls, samples: Samples) -> Features:
        """The features and the targets of samples."""
        found, problem = cls((samples.X, samples.y)), samples.problem
        found.index = samples.rows
        found.left_out = samples.left_out.describe(problem.target)
        found._about = f"{problem.target}: {', '.join(problem.quantities)}"
        return found

    @property
    def X(self) -> NDArray[Any]:
        """Features, shape (sweep, feature)."""
        return self[0]

    @property
    def y(self) -> NDArray[Any]:
        """Targets, shape (sweep,), for positions (sweep, 3)."""
        return self[1]

    def __repr__(self) -> str:
        shape = "x".join(map(str, self.X.shape))
        return f"Features of {self._about}; X is {shape} (sweep, feature); sweeps {self.left_out}"
