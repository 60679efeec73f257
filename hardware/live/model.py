"""A trained model as a localizer: its answer for one sweep, in words and as a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

from .answer import CANNOT_TELL, NOTHING_PRESSED, Answer, Questions, answer_of_classes

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


MIDWAY = "the touch changed in mid-sweep"


class Told(Protocol):
    """The class of each sweep as text, or that it cannot be told, its probability, and those of all
    classes, shape (sweep, class)."""

    @property
    def labels(self) -> NDArray: ...
    @property
    def probability(self) -> NDArray: ...
    @property
    def chances(self) -> NDArray: ...


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
    def of_each(self) -> Mapping[str, tuple[float, ...]]: ...
    @property
    def scene(self) -> str: ...
    @property
    def classes(self) -> tuple[int | str, ...]: ...
    def answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None, /) -> Told: ...
    def positions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, /
    ) -> tuple[NDArray, NDArray]: ...
    def regions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, /
    ) -> Sequence[Region | None]: ...


class Followed(Protocol):
    """An answer by a sweep and all before it. changed: that the touch changed in mid-sweep.

    coordinates: x, y and their standard deviations in mm, of a touch that is placed. region: where
    it may be, if that is told.
    """

    @property
    def label(self) -> str: ...
    @property
    def probability(self) -> float: ...
    @property
    def probabilities(self) -> NDArray: ...
    @property
    def changed(self) -> float: ...
    @property
    def coordinates(self) -> tuple[float, ...]: ...
    @property
    def region(self) -> Region | None: ...


class Follower(Protocol):
    """Lets sweeps add up."""

    def forget(self) -> None: ...
    def follow(
        self, sweep: xr.Dataset, rest: xr.Dataset | None, gap: float, during: float, /
    ) -> Followed: ...


class Questioning(Protocol):
    """As `Questions`, whose answer is yet to be put into words."""

    def next(self, seconds: NDArray, /) -> tuple[str, float] | None: ...
    def tell(self, interface: str, frequency: float, Z: complex, /) -> None: ...
    def answer(self, during: float, /) -> Followed: ...


class Asker(Protocol):
    """Chooses the readings of sweeps."""

    def begin(self, rest: xr.Dataset, gap: float, /) -> Questioning: ...


@dataclass(frozen=True)
class Asked:
    """Questions of a model, with its answer in words."""

    questioning: Questioning
    localizer: ModelLocalizer

    def next(self, seconds: NDArray, /) -> tuple[str, float] | None:
        """As of `Questions`."""
        return self.questioning.next(seconds)

    def tell(self, interface: str, frequency: float, Z: complex, /) -> None:
        """As of `Questions`."""
        self.questioning.tell(interface, frequency, Z)

    def answer(self, during: float, /) -> Answer:
        """As of `Questions`."""
        return self.localizer.told(self.questioning.answer(during))


@dataclass(frozen=True)
class ModelLocalizer:
    """A model on a skin of rows x columns pixels. size: length and width in mm.

    follower: lets sweeps add up; None: each is answered alone. asker: chooses the readings of
    sweeps; None: all of them in their order. tables: makes those of a skin by its sweeps at rest.
    """

    model: Model
    rows: int
    columns: int
    size: tuple[float, float]
    needs_rest: bool
    follower: Follower | None = None
    asker: Asker | None = None
    tables: Callable[[xr.Dataset], object] | None = None

    @property
    def target(self) -> str:
        """What it tells."""
        return self.model.target

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Hz, ascending."""
        return self.model.frequencies

    @property
    def of_each(self) -> Mapping[str, tuple[float, ...]]:
        """Hz, ascending, of interfaces that have frequencies of their own, by name."""
        return self.model.of_each

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of the interfaces that it needs the sweep of."""
        return self.model.interfaces

    @property
    def scene(self) -> str:
        """TOML text of the skin."""
        return self.model.scene

    def prepare(self, rest: xr.Dataset | None, /) -> None:
        """Have tables of the skin made, where the model makes any, and begin to follow anew."""
        if rest is not None and self.tables is not None:
            self.tables(rest)
        if self.follower is not None:
            self.follower.forget()

    def questions(self, rest: xr.Dataset | None, gap: float, /) -> Questions | None:
        """For the next sweep, where the readings are to be chosen."""
        if self.asker is None or rest is None:
            return None
        return Asked(self.asker.begin(rest, gap), self)

    def answer(
        self, sweep: xr.Dataset, rest: xr.Dataset | None, gap: float, during: float, /
    ) -> Answer:
        """Where one sweep was pressed, by it and, where they are followed, by those before it."""
        if self.follower is not None:
            return self.told(self.follower.follow(sweep, rest, gap, during))
        told = self.model.answers(sweep, rest)
        label = str(told.labels[0])
        if self.target != "position":
            names, shape = [str(each) for each in self.model.classes], (self.rows, self.columns)
            return answer_of_classes(self.target, label, names, told.chances[0], shape)
        if label == "1":
            region = self.model.regions(sweep, rest)[0]
            return _place(*self.model.positions(sweep, rest), region)
        if label == "0":
            return Answer(NOTHING_PRESSED, float(told.probability[0]))
        return Answer(CANNOT_TELL)

    def told(self, followed: Followed) -> Answer:
        """An answer in words."""
        label, probability = followed.label, followed.probability
        remark = MIDWAY if followed.changed > 0.5 else ""
        if self.target != "position":
            names = [str(each) for each in self.model.classes]
            shape = self.rows, self.columns
            chances = followed.probabilities
            answer = answer_of_classes(self.target, label, names, chances, shape)
            return replace(answer, remark=remark)
        if followed.coordinates:
            x, y, *deviation = followed.coordinates
            across, up = deviation
            words = f"x {x:.0f} mm, y {y:.0f} mm"
            shade = None if followed.region is None else followed.region.shade
            return Answer(words, probability, None, (x, y), (across, up), shade, remark)
        if label == "0":
            return Answer(NOTHING_PRESSED, probability, remark=remark)
        return Answer(CANNOT_TELL, remark=remark)


def _place(found: NDArray, deviations: NDArray, region: Region | None) -> Answer:
    x, y, strength = found[0].tolist()
    deviation = tuple(deviations[0, :2].tolist())
    words = f"x {x:.0f} mm, y {y:.0f} mm, strength {strength:.2g}"
    return Answer(
        words, position=(x, y), deviation=deviation, region=None if region is None else region.shade
    )
