"""What the reproduction asks of a localizer, which it is given and does not know."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


class Confusion(Protocol):
    """Counts of sweeps by the class they are of and the class they were taken for."""

    @property
    def labels(self) -> tuple[int | str, ...]: ...
    @property
    def counts(self) -> NDArray: ...
    @property
    def total(self) -> int: ...
    @property
    def accuracy(self) -> float: ...


class CrossValidate(Protocol):
    """5-fold cross-validation of the columns of sweeps, from some of their quantities."""

    def __call__(
        self, sweeps: xr.Dataset, *, quantities: tuple[str, ...] = ("Rs", "Cp"), seed: int = 0
    ) -> Confusion: ...


@dataclass(frozen=True)
class Localizer:
    """A localizer's functions: validate it, draw and write what came out, save a trained one."""

    cross_validate: CrossValidate
    draw: Callable[[Axes, Any], None]
    write: Callable[[Any, Path], None]
    save: Callable[[xr.Dataset, Path], None]
