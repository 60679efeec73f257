"""One touch of the skin: a pixel or a place of any shape, how strongly it is pressed, and by what.

How strongly is a factor on the capacitance, or a depth or a force of which mechanics makes one. By
what is a capacitance to earth, spread evenly over the place: 0 F of a rod, some pF of a finger.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, NoReturn

from ..sweeps import InputError


class Box(NamedTuple):
    """A rectangle between two lines each way, m."""

    left: float
    right: float
    bottom: float
    top: float


class Touched:
    """What touches say alike. finger: the capacitance of what touches there to earth, F."""

    finger: float

    def _and_finger(self, text: str) -> str:
        """The text of a touch; a rod, of 0 F, is not told."""
        return f"{text}:{self.finger!r}F" if self.finger else text


class Placed(Touched):
    """A place of the skin, and its capacitance over that at rest."""

    factor: float

    @property
    def where(self) -> str:
        """The place as text."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self._and_finger(f"{self.where}:{self.factor!r}")


@dataclass(frozen=True, order=True)
class Touch(Placed):
    """One pressed pixel, counted from 1, and its capacitance over that at rest."""

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
        """What it covers."""
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
        """The rectangle around it."""
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
        """The rectangle around it."""
        x, y = zip(*self.points, strict=True)
        return Box(min(x), max(x), min(y), max(y))

    @property
    def where(self) -> str:
        return f"poly({','.join(repr(each) for point in self.points for each in point)})"


@dataclass(frozen=True, order=True)
class AppliedStrength:
    """How a rigid flat applicator is pushed in."""

    value: float
    unit: ClassVar[str]

    def __str__(self) -> str:
        return f"{self.value!r}{self.unit}"


class Depth(AppliedStrength):
    """How far, m."""

    unit = "m"


class Force(AppliedStrength):
    """With what, N."""

    unit = "N"


Place = Touch | Rectangle | Disc | Polygon
Strength = float | Depth | Force


@dataclass(frozen=True)
class Indentation(Touched):
    """A rigid flat applicator of the shape of a place (of factor 1, 0 F), pushed into the skin."""

    place: Place
    by: Depth | Force
    finger: float = 0.0

    @property
    def factor(self) -> NoReturn:
        """None: what it does to the capacitance is for `models.mechanics` to find."""
        raise InputError(f"press {self}: needs a capacitance factor here, not a {named(self.by)}")

    @property
    def where(self) -> str:
        """The place as text."""
        return self.place.where

    def __str__(self) -> str:
        return self._and_finger(f"{self.where}:{self.by}")


AnyTouch = Place | Indentation


def place_of(touch: AnyTouch) -> Place:
    """The place that is touched, however strongly."""
    return touch.place if isinstance(touch, Indentation) else touch


def named(by: Depth | Force) -> str:
    """What the kind of strength is called."""
    return "depth" if isinstance(by, Depth) else "force"


def touch_at(place: Place, strength: Strength, finger: float = 0.0) -> AnyTouch:
    """The place touched by a factor, or pressed to a depth or by a force.

    finger: the capacitance to earth of what touches it, F.
    """
    if isinstance(strength, Depth | Force):
        return Indentation(replace(place, factor=1.0, finger=0.0), strength, finger)
    return replace(place, factor=strength, finger=finger)
