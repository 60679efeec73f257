"""Faults that skins and their readers have in service, as texts and as changes of a skin."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal, Self, get_args, get_type_hints

import numpy as np

from ..arrays import Mask, Real
from ..press.pixels import pixels_with_skin
from ..scene.contacts import Interface
from ..scene.factor_maps import Tear
from ..scene.parts import SceneParts, Setup, Skin
from ..scene.wiring_checks import BELOW
from ..sweeps import InputError

OPEN = 1e12
"""Z in ohm of a skin without any connection; no meter reads more."""
PATTERNS: dict[Any, str] = {str: r".+", int: r"\d+", float: r"\d*\.?\d+(?:[eE][+-]?\d+)?"}
"""Values in texts of faults by type; those of other types are one of a few words."""

Half = Literal["low", "high"]
TornSheets = Literal["top", "bottom", "both"]


@dataclass(frozen=True)
class SkinFault(ABC):
    """A fault of a skin or of its reader; `str` gives its text, `parse_fault` reads it.

    kind: first words of its text. form: the text, with the names of the fields in braces.
    """

    kind: ClassVar[str]
    form: ClassVar[str]

    def __init_subclass__(cls) -> None:
        cls.kind = cls.form.partition(" {")[0]

    @classmethod
    def parsed(cls, text: str) -> Self | None:
        """The fault with this text; None if the text is not of its form."""
        types = cls._types()
        values = {name: PATTERNS.get(each) or _one_of(each) for name, each in types.items()}
        groups = {name: f"(?P<{name}>{pattern})" for name, pattern in values.items()}
        found = re.fullmatch(cls.form.format(**groups), text)
        if found is None:
            return None
        converted = {name: each for name, each in types.items() if each in PATTERNS}
        return cls(**{name: converted.get(name, str)(found[name]) for name in types})

    @classmethod
    def grammar(cls) -> str:
        """The form of its text, with words to choose from and names of values in capitals."""
        each = cls._types().items()
        return cls.form.format(**{name: _one_of(kind) or name.upper() for name, kind in each})

    @classmethod
    def _types(cls) -> dict[str, Any]:
        return {field.name: get_type_hints(cls)[field.name] for field in fields(cls)}

    def __str__(self) -> str:
        each = vars(self).items()
        texts = {name: f"{x:.4g}" if isinstance(x, float) else x for name, x in each}
        return self.form.format(**texts)

    @abstractmethod
    def check(self, parts: SceneParts) -> None:
        """Raises InputError if the scene cannot have the fault."""

    def refused(self, skin: Skin, why: str) -> InputError:
        """The error that this scene cannot have the fault."""
        return InputError(f"{skin.name}: fault {str(self)!r}: {why}")

    def changed(self, parts: SceneParts) -> SceneParts | None:
        """The parts with the fault, without interfaces that are open; None if all are.

        They are the given ones if the fault is not one of sheets or foils.
        """
        return parts

    def connected(self, setup: Setup) -> Mask:
        """False for interfaces that the fault leaves open, shape (interface,)."""
        return np.ones(len(setup.interfaces), dtype=bool)

    def remaining(self, skin: Skin) -> Mask:
        """False for contacts that are none any more, shape (contact,)."""
        return np.ones(len(skin.contacts), dtype=bool)

    def foam(self, skin: Skin, grid: tuple[int, int]) -> Real:
        """Factors on the capacitance of the unpressed cells, shape `grid` (rows, columns)."""
        return np.ones(grid)

    def gain(self, frequency: Real) -> Real:
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

    name: str
    form = "dead foil {name}"

    def check(self, parts: SceneParts) -> None:
        _check_foil(self, parts.skin)
        if not parts.setup.one_to_one:
            needed = "needs interfaces that are read one by one; leave out `driven_with`"
            raise self.refused(parts.skin, needed)

    def changed(self, parts: SceneParts) -> SceneParts | None:
        skin, setup = parts.skin, parts.setup
        kept = [
            each.model_copy(update={"frequencies": None, **self._driven(each)})
            for each, connected in zip(setup.interfaces, self.connected(setup), strict=True)
            if connected
        ]
        if not kept:
            return None
        there = zip(skin.contacts, self.remaining(skin), strict=True)
        contacts = tuple(contact for contact, remains in there if remains)
        return replace(
            parts,
            skin=replace(skin, contacts=contacts),
            setup=replace(setup, interfaces=tuple(kept)),
        )

    def connected(self, setup: Setup) -> Mask:
        return np.array([all(self._driven(each).values()) for each in setup.interfaces])

    def remaining(self, skin: Skin) -> Mask:
        return np.array([contact.name not in self._names for contact in skin.contacts])

    @property
    def place(self) -> str:
        return self.name

    @property
    def _names(self) -> tuple[str, str]:
        """Names of the foil and of the earth below it, if there is one."""
        return self.name, f"{BELOW}{self.name}"

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

    name: str
    left: Half
    form = "half foil {name} {left}"

    def check(self, parts: SceneParts) -> None:
        _check_foil(self, parts.skin)
        if parts.skin.mesh is not None:
            needed = "needs a foil with a span; foils of a mesh from a file have none"
            raise self.refused(parts.skin, needed)

    def changed(self, parts: SceneParts) -> SceneParts:
        low, high = parts.skin.contact(self.name).span
        middle = (low + high) / 2
        span = [low, middle] if self.left == "low" else [middle, high]
        return parts.scene.with_({f"contact.{self.name}.span": span}).parts

    @property
    def place(self) -> str:
        return self.name


@dataclass(frozen=True)
class TornSheet(SkinFault):
    """A straight tear of a sheet or of both; see `Tear` for edge, at and length."""

    sheets: TornSheets
    edge: Literal["left", "right", "bottom", "top"]
    at: float
    length: float
    form = "tear {sheets} {edge} {at} {length}"

    def check(self, parts: SceneParts) -> None:
        skin = parts.skin
        if skin.one_conductor and self.sheets != "top":
            raise self.refused(parts.skin, "the bottom is earth; tear the top")
        if skin.outline is not None or skin.mesh is not None:
            raise self.refused(parts.skin, "needs a rectangular skin")
        for name in self._torn:
            if skin.sheet(name).map is not None:
                taken = f"the sheet has `skin.{name}.map`, and takes one map only"
                raise self.refused(parts.skin, taken)
        self.changed(parts)

    def changed(self, parts: SceneParts) -> SceneParts:
        table = Tear.model_construct(edge=self.edge, at=self.at, length=self.length)
        maps = {f"skin.{name}.map": table.model_dump() for name in self._torn}
        return parts.scene.with_(maps).parts

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
    form = "stuck spot {row},{column}:{factor}"

    def check(self, parts: SceneParts) -> None:
        if (self.row, self.column) not in pixels_with_skin(parts.skin):
            raise self.refused(parts.skin, "there is no such pixel")
        if not self.factor >= 1:
            raise self.refused(parts.skin, "its factor must be >= 1")

    def foam(self, skin: Skin, grid: tuple[int, int]) -> Real:
        factors = np.ones(skin.pixels.shape)
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
    form = "aged gain {low} {high}"

    def check(self, parts: SceneParts) -> None:
        if not min(self.low, self.high) > 0:
            raise self.refused(parts.skin, "its factors must be > 0")

    def gain(self, frequency: Real) -> Real:
        ends = np.log(frequency[[0, -1]])
        if ends[0] == ends[1]:
            return np.full(frequency.shape, self.low)
        return np.interp(np.log(frequency), ends, [self.low, self.high]).astype(np.float64)


SKIN_FAULTS: tuple[type[SkinFault], ...] = (DeadFoil, HalfFoil, TornSheet, StuckSpot, AgedGain)


def parse_fault(text: str, parts: SceneParts) -> SkinFault:
    """The fault with this text. Raises InputError if there is none or the skin cannot have it."""
    fault = _fault_of(text)
    if fault is None:
        known = ", ".join(each.grammar() for each in SKIN_FAULTS)
        raise InputError(f"fault {text!r} must be one of {known}")
    fault.check(parts)
    return fault


def kind_of_fault(text: str) -> str:
    """The kind of a fault in a text; empty for an empty text."""
    return next((each.kind for each in SKIN_FAULTS if text.startswith(each.kind)), "")


def place_of_fault(text: str) -> str:
    """The place of a fault in its text; empty for a reader's fault and for an empty text."""
    fault = _fault_of(text)
    return "" if fault is None else fault.place


def _fault_of(text: str) -> SkinFault | None:
    each = (kind.parsed(text.strip()) for kind in SKIN_FAULTS)
    return next((fault for fault in each if fault is not None), None)


def _one_of(words: Any) -> str:
    return "|".join(get_args(words))


def _check_foil(fault: DeadFoil | HalfFoil, skin: Skin) -> None:
    names = [contact.name for contact in skin.foils]
    if fault.name not in names:
        raise fault.refused(skin, f"must name one of {', '.join(names)}")
