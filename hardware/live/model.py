"""A trained model as a localizer: its answer for one sweep, in words and as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from .answer import CANNOT_TELL, NOTHING_PRESSED, Answer, answer_of_classes

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


class Told(Protocol):
    """The class of each sweep as text, or that it cannot be told, and its probability."""

    @property
    def labels(self) -> NDArray: ...
    @property
    def probability(self) -> NDArray: ...


class Region(Protocol):
    """Where a touch may be. shade: how likely places x, y in mm are, 0 outside, at most 1."""

    def shade(self, x: NDArray, y: NDArray, /) -> NDArray: ...


class Model(Protocol):
    """What a trained model knows of itself and can be asked; rest: sweeps of the skin at rest.

    positions: x and y in mm and strength, and their standard deviations, shape (sweep, 3) each.
    regions: the smallest that hold a touch with 95 %.
    """

    @property
    def target(self) -> str: ...
    @property
    def interfaces(self) -> tuple[str, ...]: ...
    @property
    def frequencies(self) -> tuple[float, ...]: ...
    @property
    def scene(self) -> str: ...
    def answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None, /) -> Told: ...
    def probabilities(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, /
    ) -> tuple[NDArray, NDArray]: ...
    def positions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, /
    ) -> tuple[NDArray, NDArray]: ...
    def regions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, /
    ) -> Sequence[Region | None]: ...


@dataclass(frozen=True)
class ModelLocalizer:
    """A model on a skin of rows x columns pixels. size: length and width in mm."""

    model: Model
    rows: int
    columns: int
    size: tuple[float, float]
    needs_rest: bool

    @property
    def target(self) -> str:
        """What it tells."""
        return self.model.target

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Hz, ascending."""
        return self.model.frequencies

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces that it needs the sweep of."""
        return self.model.interfaces

    @property
    def scene(self) -> str:
        """TOML text of the skin."""
        return self.model.scene

    def answer(self, sweep: xr.Dataset, rest: xr.Dataset | None, /) -> Answer:
        """Where one sweep was pressed."""
        told = self.model.answers(sweep, rest)
        label = str(told.labels[0])
        if self.target != "position":
            classes, known = self.model.probabilities(sweep, rest)
            names = [str(each) for each in classes]
            return answer_of_classes(self.target, label, names, known[0], (self.rows, self.columns))
        if label == "1":
            region = self.model.regions(sweep, rest)[0]
            return _place(*self.model.positions(sweep, rest), region)
        if label == "0":
            return Answer(NOTHING_PRESSED, float(told.probability[0]))
        return Answer(CANNOT_TELL)


def _place(found: NDArray, deviations: NDArray, region: Region | None) -> Answer:
    x, y, strength = found[0].tolist()
    deviation = tuple(deviations[0, :2].tolist())
    words = f"x {x:.0f} mm, y {y:.0f} mm, strength {strength:.2g}"
    return Answer(
        words, position=(x, y), deviation=deviation, region=None if region is None else region.shade
    )
