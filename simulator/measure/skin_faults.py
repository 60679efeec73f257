"""Faults that skins and their readers have in service, as texts and as changes of a scene."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray

from ..press.pixels import pixels_with_skin
from ..scene.maps.tear import Tear
from ..scene.readings.contacts import EDGES, Interface
from ..scene.readings.one_conductor import BELOW
from ..scene.scene import Scene
from ..sweeps import InputError

OPEN = 1e12
"""Z in ohm of a skin without any connection; no meter reads more."""
NUMBER = r"\d*\.?\d+(?:[eE][+-]?\d+)?"

Half = Literal["low", "high"]
TornSheets = Literal["top", "bottom", "both"]


@dataclass(frozen=True)
class SkinFault(ABC):
    """A fault of a skin or of its reader; `str` gives its text, `parse_fault` reads it."""

    kind: ClassVar[str]
    grammar: ClassVar[str]

    @classmethod
    @abstractmethod
    def parsed(cls, rest: str) -> Self | None:
        """The fault that the text after its kind describes; None if it describes none."""

    @abstractmethod
    def check(self, scene: Scene) -> None:
        """Raises InputError if the scene cannot have the fault."""

    def changed(self, scene: Scene) -> Scene | None:
        """The scene with the fault, without interfaces that are open; None if all are.

        It is the scene itself if the fault is not one of sheets or foils.
        """
        return scene

    def connected(self, scene: Scene) -> NDArray[np.bool_]:
        """False for interfaces that the fault leaves open, shape (interface,)."""
        return np.ones(len(scene.interfaces), dtype=bool)

    def remaining(self, scene: Scene) -> NDArray[np.bool_]:
        """False for contacts that are none any more, shape (contact,)."""
        return np.ones(len(scene.contacts), dtype=bool)

    def foam(self, scene: Scene, grid: tuple[int, int]) -> NDArray[np.float64]:
        """Factors on the capacitance of the unpressed cells, shape `grid` (rows, columns)."""
        return np.ones(grid)

    def gain(self, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        """Factors on the readings, shape (frequency,). frequency: Hz."""
        return np.ones(frequency.shape)

    @property
    def place(self) -> str:
        """Text of the place on the skin; empty for a fault of the reader."""
        return ""


@dataclass(frozen=True)
class DeadFoil(SkinFault):
    """A foil without contact to its sheet.

    An interface without any foil left at a terminal is open. Its meter reads the leads alone.
    """

    contact: str
    kind = "dead foil"
    grammar = "dead foil NAME"

    @classmethod
    def parsed(cls, rest: str) -> Self | None:
        return cls(rest) if rest else None

    def __str__(self) -> str:
        return f"{self.kind} {self.contact}"

    def check(self, scene: Scene) -> None:
        _check_foil(self, self.contact, scene)
        if not scene.reading.one_to_one:
            raise InputError(
                f"{scene.name}: fault {str(self)!r} needs interfaces that are read one by one; "
                "leave out `driven_with`"
            )

    def changed(self, scene: Scene) -> Scene | None:
        kept = [
            each.model_copy(update={"frequencies": None, **self._driven(each)})
            for each, connected in zip(scene.interfaces, self.connected(scene), strict=True)
            if connected
        ]
        if not kept:
            return None
        there = zip(scene.contacts, self.remaining(scene), strict=True)
        contacts = tuple(contact for contact, remains in there if remains)
        return scene.model_copy(update={"contacts": contacts, "interfaces": tuple(kept)})

    def connected(self, scene: Scene) -> NDArray[np.bool_]:
        return np.array([all(self._driven(each).values()) for each in scene.interfaces])

    def remaining(self, scene: Scene) -> NDArray[np.bool_]:
        return np.array([contact.name not in self._names for contact in scene.contacts])

    @property
    def place(self) -> str:
        return self.contact

    @property
    def _names(self) -> tuple[str, str]:
        """Names of the foil and of the earth below it, if there is one."""
        return self.contact, f"{BELOW}{self.contact}"

    def _driven(self, interface: Interface) -> dict[str, tuple[str, ...]]:
        """Foils of both terminals of an interface that still have contact."""
        both = {"high": interface.high, "low": interface.low}
        return {
            terminal: tuple(name for name in names if name not in self._names)
            for terminal, names in both.items()
        }


@dataclass(frozen=True)
class HalfFoil(SkinFault):
    """A foil of which one half of the length has no contact; `left` is the half that has."""

    contact: str
    left: Half
    kind = "half foil"
    grammar = "half foil NAME low|high"

    @classmethod
    def parsed(cls, rest: str) -> Self | None:
        for left in get_args(Half):
            name = rest.removesuffix(f" {left}")
            if name not in ("", rest):
                return cls(name, left)
        return None

    def __str__(self) -> str:
        return f"{self.kind} {self.contact} {self.left}"

    def check(self, scene: Scene) -> None:
        _check_foil(self, self.contact, scene)
        if scene.skin.mesh is not None:
            raise InputError(
                f"{scene.name}: fault {str(self)!r} needs a foil with a span; foils of a mesh "
                "from a file have none"
            )

    def changed(self, scene: Scene) -> Scene:
        low, high = scene.contact(self.contact).span
        middle = (low + high) / 2
        span = [low, middle] if self.left == "low" else [middle, high]
        return scene.with_({f"contact.{self.contact}.span": span})

    @property
    def place(self) -> str:
        return self.contact


@dataclass(frozen=True)
class TornSheet(SkinFault):
    """A straight tear of a sheet or of both; see `Tear` for edge, at and length."""

    sheets: TornSheets
    edge: Literal["left", "right", "bottom", "top"]
    at: float
    length: float
    kind = "tear"
    grammar = "tear top|bottom|both EDGE AT LENGTH"

    @classmethod
    def parsed(cls, rest: str) -> Self | None:
        sheets, edges = "|".join(get_args(TornSheets)), "|".join(EDGES)
        found = re.fullmatch(rf"({sheets}) ({edges}) ({NUMBER}) ({NUMBER})", rest)
        if found is None:
            return None
        return cls(found[1], found[2], float(found[3]), float(found[4]))  # type: ignore[arg-type]

    def __str__(self) -> str:
        return f"{self.kind} {self.sheets} {self.edge} {self.at:.4g} {self.length:.4g}"

    def check(self, scene: Scene) -> None:
        if scene.skin.one_conductor and self.sheets != "top":
            raise InputError(
                f"{scene.name}: fault {str(self)!r}: the bottom is earth; tear the top"
            )
        if scene.skin.outline is not None or scene.skin.mesh is not None:
            raise InputError(f"{scene.name}: fault {str(self)!r} needs a rectangular skin")
        for name in self._torn:
            if scene.skin.sheet(name).map is not None:
                raise InputError(
                    f"{scene.name}: fault {str(self)!r}: the sheet has `skin.{name}.map`, and "
                    "takes one map only"
                )
        self.changed(scene)

    def changed(self, scene: Scene) -> Scene:
        table = Tear.model_construct(edge=self.edge, at=self.at, length=self.length)
        return scene.with_({f"skin.{name}.map": table.model_dump() for name in self._torn})

    @property
    def place(self) -> str:
        return f"{self.sheets} {self.edge} {self.at:.4g}"

    @property
    def _torn(self) -> tuple[Literal["top", "bottom"], ...]:
        return ("top", "bottom") if self.sheets == "both" else (self.sheets,)


@dataclass(frozen=True)
class StuckSpot(SkinFault):
    """A pixel whose foam stays pressed; factor: its capacitance over the unpressed one."""

    row: int
    column: int
    factor: float
    kind = "stuck spot"
    grammar = "stuck spot ROW,COLUMN:FACTOR"

    @classmethod
    def parsed(cls, rest: str) -> Self | None:
        found = re.fullmatch(rf"(\d+),(\d+):({NUMBER})", rest)
        return None if found is None else cls(int(found[1]), int(found[2]), float(found[3]))

    def __str__(self) -> str:
        return f"{self.kind} {self.place}:{self.factor:.4g}"

    def check(self, scene: Scene) -> None:
        if (self.row, self.column) not in pixels_with_skin(scene):
            raise InputError(f"{scene.name}: fault {str(self)!r}: there is no such pixel")
        if not self.factor >= 1:
            raise InputError(f"{scene.name}: fault {str(self)!r}: its factor must be >= 1")

    def foam(self, scene: Scene, grid: tuple[int, int]) -> NDArray[np.float64]:
        factors = np.ones(scene.pixels.shape)
        factors[self.row - 1, self.column - 1] = self.factor
        cells = grid[0] // factors.shape[0], grid[1] // factors.shape[1]
        return factors.repeat(cells[0], axis=0).repeat(cells[1], axis=1)

    @property
    def place(self) -> str:
        return f"{self.row},{self.column}"


@dataclass(frozen=True)
class AgedGain(SkinFault):
    """A reader whose gain has changed: factors at the lowest and at the highest frequency."""

    low: float
    high: float
    kind = "aged gain"
    grammar = "aged gain LOW HIGH"

    @classmethod
    def parsed(cls, rest: str) -> Self | None:
        found = re.fullmatch(rf"({NUMBER}) ({NUMBER})", rest)
        return None if found is None else cls(float(found[1]), float(found[2]))

    def __str__(self) -> str:
        return f"{self.kind} {self.low:.4g} {self.high:.4g}"

    def check(self, scene: Scene) -> None:
        if not min(self.low, self.high) > 0:
            raise InputError(f"{scene.name}: fault {str(self)!r}: its factors must be > 0")

    def gain(self, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        ends = np.log(frequency[[0, -1]])
        if ends[0] == ends[1]:
            return np.full(frequency.shape, self.low)
        return np.interp(np.log(frequency), ends, [self.low, self.high]).astype(np.float64)


SKIN_FAULTS: tuple[type[SkinFault], ...] = (DeadFoil, HalfFoil, TornSheet, StuckSpot, AgedGain)


def parse_fault(text: str, scene: Scene) -> SkinFault:
    """The fault with this text. Raises InputError if there is none or the scene cannot have it."""
    for each in SKIN_FAULTS:
        if text.startswith(f"{each.kind} "):
            found = each.parsed(text.removeprefix(each.kind).strip())
            if found is not None:
                found.check(scene)
                return found
    known = ", ".join(each.grammar for each in SKIN_FAULTS)
    raise InputError(f"fault {text!r} must be one of {known}")


def kind_of_fault(text: str) -> str:
    """The kind of a fault in a text; empty for an empty text."""
    return next((each.kind for each in SKIN_FAULTS if text.startswith(each.kind)), "")


def place_of_fault(text: str) -> str:
    """The place of a fault in its text; empty for a reader's fault and for an empty text."""
    for each in SKIN_FAULTS:
        if text.startswith(f"{each.kind} "):
            found = each.parsed(text.removeprefix(each.kind).strip())
            return "" if found is None else found.place
    return ""


def _check_foil(fault: SkinFault, name: str, scene: Scene) -> None:
    names = [contact.name for contact in scene.foils]
    if name not in names:
        raise InputError(f"{scene.name}: fault {str(fault)!r} must name one of {', '.join(names)}")
