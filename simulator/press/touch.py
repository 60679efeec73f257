"""One touch of the skin: a pixel or a place of any shape, its strength, and the finger or rod.

The strength is a factor on the capacitance, or a depth or a force that mechanics converts to a
factor. A finger is a capacitance to earth, spread uniformly over the place: 0 F for a rod, some pF
for a finger.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, NoReturn

from ..sweeps import InputError


class Box(NamedTuple):
    """Rectangle between two lines in each direction, m."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def area(self) -> float:
        """Area, m²."""
        return (self.right - self.left) * (self.top - self.bottom)


class Touched:
    """Common part of all touches. finger: capacitance of the finger there to earth, F."""

    finger: float

    def _and_finger(self, text: str) -> str:
        """Text of a touch with its finger; a rod, of 0 F, is left out."""
        return f"{text}:{self.finger!r}F" if self.finger else text


class Placed(Touched):
    """A place of the skin, and its capacitance over the unpressed one."""

    factor: float

    @property
    def where(self) -> str:
        """Text of the place."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self._and_finger(f"{self.where}:{self.factor!r}")


@dataclass(frozen=True, order=True)
class Touch(Placed):
    """One pressed pixel, counted from 1, and its capacitance over the unpressed one."""

    row: int
    column: int
    factor: float
    finger: float = 0.0

    @property
    def where(self) -> str:
        return f"{self.row},{self.column}"


@dataclass(frozen=True, order=True)
class Rectangle(Placed):
    """A rectangle of the skin around (x, y), width along x, all in m, and its factor."""

    x: float
    y: float
    width: float
    height: float
    factor: float
    finger: float = 0.0

    @property
    def box(self) -> Box:
        """The rectangle itself."""
        x, y, half_width, half_height = self.x, self.y, self.width / 2, self.height / 2
        return Box(x - half_width, x + half_width, y - half_height, y + half_height)

    @property
    def where(self) -> str:
        return f"rect({self.x!r},{self.y!r},{self.width!r},{self.height!r})"


@dataclass(frozen=True, order=True)
class Disc(Placed):
    """A disc of the skin around (x, y), all in m, and its factor."""

    x: float
    y: float
    radius: float
    factor: float
    finger: float = 0.0

    @property
    def box(self) -> Box:
        """Rectangle around the disc."""
        x, y, radius = self.x, self.y, self.radius
        return Box(x - radius, x + radius, y - radius, y + radius)

    @property
    def where(self) -> str:
        return f"disc({self.x!r},{self.y!r},{self.radius!r})"


@dataclass(frozen=True, order=True)
class Polygon(Placed):
    """A polygon of the skin with corners (x, y) in m, in either sense, and its factor."""

    points: tuple[tuple[float, float], ...]
    factor: float
    finger: float = 0.0

    @property
    def box(self) -> Box:
        """Rectangle around the polygon."""
        x, y = zip(*self.points, strict=True)
        return Box(min(x), max(x), min(y), max(y))

    @property
    def where(self) -> str:
        return f"poly({','.join(repr(each) for point in self.points for each in point)})"


@dataclass(frozen=True, order=True)
class AppliedStrength:
    """Depth or force of a rigid flat applicator."""

    value: float
    unit: ClassVar[str]

    def __str__(self) -> str:
        return f"{self.value!r}{self.unit}"


class Depth(AppliedStrength):
    """Depth, m."""

    unit = "m"


class Force(AppliedStrength):
    """Force, N."""

    unit = "N"


Place = Touch | Rectangle | Disc | Polygon
Strength = float | Depth | Force


@dataclass(frozen=True)
class Indentation(Touched):
    """A rigid flat applicator of the shape of a place (of factor 1, 0 F), pressed into the skin."""

    place: Place
    by: Depth | Force
    finger: float = 0.0

    @property
    def factor(self) -> NoReturn:
        """Raises InputError: `models.mechanics` computes the factor."""
        raise InputError(
            f"press {self}: needs a capacitance factor here, not a {strength_name(self.by)}"
        )

    @property
    def where(self) -> str:
        """Text of the place."""
        return self.place.where

    def __str__(self) -> str:
        return self._and_finger(f"{self.where}:{self.by}")


AnyTouch = Place | Indentation


def place_of(touch: AnyTouch) -> Place:
    """Touched place, without its strength."""
    return touch.place if isinstance(touch, Indentation) else touch


def strength_name(by: Depth | Force) -> str:
    """Name of the kind of strength."""
    return "depth" if isinstance(by, Depth) else "force"


def touch_at(place: Place, strength: Strength, finger: float = 0.0) -> AnyTouch:
    """Touch at a place by a factor, a depth or a force. finger: its capacitance to earth, F."""
    if isinstance(strength, Depth | Force):
        return Indentation(replace(place, factor=1.0, finger=0.0), strength, finger)
    return replace(place, factor=strength, finger=finger)
