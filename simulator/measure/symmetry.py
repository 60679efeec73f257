"""Pixels with the same impedance when pressed, by the symmetry of a skin.

A mapping of the skin onto itself that preserves sheets, foam, foils and the connections of
interfaces gives the Z of a pixel at its image as well. So does one that exchanges the two sheets if
their surroundings are equal, or the two sides of every interface: the current into the low terminal
at 0 V for 1 V at the high one is the same in reverse, unless a guard follows one of them
or a reader of gains has low at earth.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Real
from ..scene.contacts import Contact, path
from ..scene.factor_maps import FactorMap
from ..scene.parts import Pressing, Setup, Skin
from ..scene.skin import Electrode, Sheet, SheetsAndFoam
from ..scene.skin_region import curves
from ..scene.wiring_checks import conductor_groups

Pixel = tuple[int, int]
"""(row, column), counted from 1; (0, 0) is the unpressed skin."""
UNPRESSED: Pixel = (0, 0)

NEAR = 1e-9
"""Tolerance of equality: over the skin's longer side, and relatively for factors."""
FOIL_POINTS = 9
"""Points on each foil that are compared: both ends, and equidistant ones between."""
MAP_POINTS = 17
"""Points along each side at which maps are compared."""
OTHER: dict[Electrode, Electrode] = {"top": "bottom", "bottom": "top"}


@dataclass(frozen=True)
class Mapping:
    """Mapping of the rectangle of pixels about its middle.

    swapped: x and y change places. turned: True for each coordinate that is then reversed.
    exchanged: True if the sheets change places, too.
    """

    swapped: bool
    turned: tuple[bool, bool]
    exchanged: bool

    @property
    def none(self) -> bool:
        """True for the identity."""
        return not (self.swapped or any(self.turned))

    def place(self, x: Real, sides: tuple[float, float]) -> Real:
        """Images of positions x, m, shape (2, ...)."""
        moved = x[::-1] if self.swapped else x
        return np.stack(
            [s - v if t else v for v, s, t in zip(moved, sides, self.turned, strict=True)]
        )

    def pixel(self, pixel: Pixel, shape: tuple[int, int]) -> Pixel:
        """Image of a pixel on a grid of (rows, columns)."""
        column, row = pixel if self.swapped else pixel[::-1]
        rows, columns = shape
        return (
            rows + 1 - row if self.turned[1] else row,
            columns + 1 - column if self.turned[0] else column,
        )

    def angle(self, angle: float) -> float:
        """Image of a direction, rad."""
        along = np.array([np.cos(angle), np.sin(angle)])
        x, y = np.where(self.turned, -1.0, 1.0) * (along[::-1] if self.swapped else along)
        return float(np.arctan2(y, x))

    def electrode(self, name: Electrode) -> Electrode:
        """Image of an electrode."""
        return OTHER[name] if self.exchanged else name


MAPPINGS = [
    Mapping(swapped, (x, y), exchanged)
    for exchanged, swapped, x, y in itertools.product((False, True), repeat=4)
]


def representative(skin: Skin, setup: Setup, pressing: Pressing) -> Callable[[Pixel], Pixel]:
    """Function from a pixel to the one of lowest row and column with the same impedance.

    On a mesh from a file every pixel counts as its own.
    """
    found = (
        [] if skin.mesh is not None else [m for m in MAPPINGS if _kept(skin, setup, pressing, m)]
    )

    def of(pixel: Pixel) -> Pixel:
        if pixel == UNPRESSED:
            return pixel
        return min([pixel, *(mapping.pixel(pixel, skin.pixels.shape) for mapping in found)])

    return of


def _kept(skin: Skin, setup: Setup, pressing: Pressing, mapping: Mapping) -> bool:
    """True if a mapping preserves everything that the impedance depends on."""
    return (
        not mapping.none
        and _sides_kept(skin, mapping)
        and (not mapping.exchanged or _equal_surroundings(skin, pressing))
        and _layers_kept(skin, mapping)
        and _outline_kept(skin, mapping)
        and _wiring_kept(skin, setup, mapping)
    )


def _equal_surroundings(skin: Skin, pressing: Pressing) -> bool:
    """True if both sheets have equal surroundings, and no finger touches one of them."""
    return pressing.finger is None and (skin.around is None or skin.around.symmetric_sides)


def _directed(skin: Skin, setup: Setup) -> bool:
    """True if high and low are not equivalent.

    A guard follows one of them, or a reader of gains has its low at earth.
    """
    around = skin.around
    return around is not None and (setup.gain or any(b.follows for b in around.body))


def _sides_kept(skin: Skin, mapping: Mapping) -> bool:
    skin, (rows, columns) = skin, skin.pixels.shape
    stretched = skin.stretch.ratios if skin.stretch else (1.0, 1.0)
    square = skin.length == skin.width and rows == columns and stretched[0] == stretched[1]
    return square or not mapping.swapped


def _layers_kept(skin: SheetsAndFoam, mapping: Mapping) -> bool:
    pairs = [(sheet, skin.sheet(mapping.electrode(name))) for name, sheet in _sheets(skin)]
    return all(_sheet_becomes(*pair, mapping, skin) for pair in pairs) and _map_becomes(
        skin.foam.map, skin.foam.map, mapping, skin
    )


def _sheets(skin: SheetsAndFoam) -> Iterator[tuple[Electrode, Sheet]]:
    yield "top", skin.top
    yield "bottom", skin.bottom


def _sheet_becomes(sheet: Sheet, image: Sheet, mapping: Mapping, skin: SheetsAndFoam) -> bool:
    if (sheet.sheet_resistance, sheet.piezoresistance) != (
        image.sheet_resistance,
        image.piezoresistance,
    ):
        return False
    one, other = sheet.anisotropy, image.anisotropy
    if one is not None and other is not None:
        off = mapping.angle(one.angle) - other.angle
        if one.ratio != other.ratio or abs(np.sin(off)) > NEAR:
            return False
    elif one is not other:
        return False
    return _map_becomes(sheet.map, image.map, mapping, skin)


def _map_becomes(
    one: FactorMap | None, other: FactorMap | None, mapping: Mapping, skin: SheetsAndFoam
) -> bool:
    if one is None or other is None:
        return one is other
    lines = (np.linspace(0, side, MAP_POINTS) for side in skin.sides)
    grid = np.stack(np.meshgrid(*lines)).reshape(2, -1)
    x = np.hstack([grid, one.details(skin.sides)])
    moved = other.factors(mapping.place(x, skin.sides), skin.sides)
    return np.allclose(one.factors(x, skin.sides), moved, rtol=NEAR, atol=0)


def _outline_kept(skin: SheetsAndFoam, mapping: Mapping) -> bool:
    """True if every curve around the skin is mapped onto one of them."""
    if skin.outline is None:
        return True
    drawn = [np.array([curve.at(m) for m in _marks(curve.marks)]).T for curve in curves(skin)]
    near = NEAR * max(skin.sides)
    return all(
        any(_same(mapping.place(one, skin.sides), other, near) for other in drawn) for one in drawn
    )


def _marks(corners: Real) -> Real:
    """Points along a curve: its corners, or eighths of a circle."""
    return corners[:-1] if len(corners) > 2 else np.linspace(0, corners[-1], 8, endpoint=False)


def _same(one: Real, other: Real, near: float) -> bool:
    """True if two sets of points (2, n) are equal."""
    if one.shape != other.shape:
        return False
    distance = np.abs(one[:, :, None] - other[:, None, :]).max(axis=0)
    return bool((distance.min(axis=0) <= near).all() and (distance.min(axis=1) <= near).all())


@dataclass(frozen=True)
class _Foil:
    contact: Contact
    skin: SheetsAndFoam

    @cached_property
    def places(self) -> Real:
        """Points on the foil, m, shape (2, FOIL_POINTS)."""
        return path(self.contact, self.skin, FOIL_POINTS - 1)

    def becomes(self, other: _Foil, mapping: Mapping) -> bool:
        """True if a mapping maps the foil onto another one."""
        return (
            mapping.electrode(self.contact.electrode) == other.contact.electrode
            and self.contact.resistance == other.contact.resistance
            and self.contact.width == other.contact.width
            and _same(
                mapping.place(self.places, self.skin.sides),
                other.places,
                NEAR * max(self.skin.sides),
            )
        )


def _images(skin: Skin, mapping: Mapping) -> dict[str, str | None]:
    """Name of the image of each foil."""
    foils = [_Foil(contact, skin) for contact in skin.contacts]
    return {
        foil.contact.name: next(
            (other.contact.name for other in foils if foil.becomes(other, mapping)), None
        )
        for foil in foils
    }


def repeated(skin: Skin, setup: Setup, pressing: Pressing) -> list[tuple[str, str]]:
    """Interfaces with the same impedance as an earlier one for any press, and that earlier one.

    Gains are left out: they differ by what drives and loads the nodes.
    They have the same two sides, in either order, or after the exchange of equal sheets, and no
    other frequencies: a further one only averages the meter's errors.
    """
    group = conductor_groups(skin.contacts, skin)
    terminal = dict(zip((contact.name for contact in skin.contacts), group, strict=True))
    images = _exchanged(skin, pressing)
    kind = tuple if _directed(skin, setup) else frozenset
    known: dict[Collection[frozenset[int]], list[str]] = {}
    found = []
    for interface in setup.interfaces:
        if interface.reader == "gain":
            continue
        sides = interface.high, interface.low
        equivalent = [
            kind(frozenset(terminal[as_is[name]] for name in side) for side in sides)
            for as_is in ({name: name for name in terminal}, *images)
        ]
        own = set(setup.frequency_at(interface.name))
        earlier = next(
            (
                name
                for each in equivalent
                for name in known.get(each, [])
                if own <= set(setup.frequency_at(name))
            ),
            None,
        )
        if earlier is None:
            known.setdefault(equivalent[0], []).append(interface.name)
        else:
            found.append((interface.name, earlier))
    return found


def _exchanged(skin: Skin, pressing: Pressing) -> list[dict[str, str]]:
    """Image of every foil if the sheets can change places, else an empty list."""
    exchange = Mapping(swapped=False, turned=(False, False), exchanged=True)
    same = _layers_kept(skin, exchange) and _equal_surroundings(skin, pressing)
    if skin.mesh is not None or not same:
        return []
    images = {name: image for name, image in _images(skin, exchange).items() if image is not None}
    return [images] if len(images) == len(skin.contacts) else []


def describe_repeated(skin: Skin, setup: Setup, pressing: Pressing) -> list[str]:
    """Sentence for each repeated interface."""
    return [
        f"{name}: has the impedance of {earlier} by symmetry; it only averages the meter's errors"
        for name, earlier in repeated(skin, setup, pressing)
    ]


def _wiring_kept(skin: Skin, setup: Setup, mapping: Mapping) -> bool:
    """True if every foil has an image, and every interface connects the images in the same way."""
    images = _images(skin, mapping)
    if None in images.values():
        return False
    for interface in setup.interfaces:
        sides = [frozenset(interface.high), frozenset(interface.low)]
        moved = [frozenset(images[name] for name in side) for side in sides]
        if moved != sides and (_directed(skin, setup) or moved != sides[::-1]):
            return False
    return True
