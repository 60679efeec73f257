"""Contacts of a moment: points with a force, and images of depth or pressure on the skin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Integer, Real
from ...sweeps import InputError
from ...sweeps.free_space import check_memory

MAX_CONTACTS = 10_000
"""Contacts on one skin: time grows with the square of their number."""
COPIES = 4
"""Memory of contacts over that of their table: discs under each as well."""
STRENGTHS = ("force", "depth", "factor")
KINDS = (*STRENGTHS, "depth image", "pressure image")
COLUMNS = ("x", "y", "strength", "radius", "curvature_radius", "width", "height")
DEFAULTS = np.array([np.nan, np.nan, np.nan, np.inf, np.inf, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class PointContacts:
    """Contacts at points of the skin, each pressing a patch around its point.

    Exactly one strength is given: force, depth or factor. The end of the indenter is flat and round
    (radius), a sphere (curvature_radius) or a flat rectangle (size). Arrays have the shape
    (contact,), or (skin, contact) for many skins; one number applies to all contacts.

    x, y: position on the flat skin, m; x runs along the length and y along the width. force: force
    normal to the skin, >= 0, N. radius: radius of a round patch, m; with curvature_radius, the
    limit of the sphere's patch. curvature_radius: radius of a spherical indenter, m; the foam's law
    gives its patch (Hertz's contact on a Winkler foundation). size: width along x and height along
    y, m, shape (..., 2). depth: indentation of the foam under the point, m. factor: capacitance of
    the patch over the unpressed one. count: number of valid contacts of each skin, the first in its
    row, shape (skin,); all by default. Raises InputError unless exactly one strength is given, and
    if arrays do not match.
    """

    x: ArrayLike
    y: ArrayLike
    force: ArrayLike | None = None
    radius: ArrayLike | None = None
    curvature_radius: ArrayLike | None = None
    size: ArrayLike | None = None
    depth: ArrayLike | None = None
    factor: ArrayLike | None = None
    count: ArrayLike | None = None
    by: str = field(init=False, repr=False)
    values: Real = field(init=False, repr=False)
    counts: Integer = field(init=False, repr=False)

    def __post_init__(self) -> None:
        by = self._strength()
        if self.radius is None and self.curvature_radius is None and self.size is None:
            raise InputError("PointContacts: needs radius, curvature_radius or size, in m")
        if self.size is not None and (self.radius, self.curvature_radius) != (None, None):
            raise InputError("PointContacts: takes size, or radius and curvature_radius, not both")
        try:
            values = self._table(getattr(self, by))
            counts = _counts(self.count, *values.shape[:2])
        except InputError:
            raise
        except (ValueError, TypeError) as error:
            raise InputError(f"PointContacts: arrays do not match: {error}") from None
        object.__setattr__(self, "by", by)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "counts", counts)

    @property
    def kind(self) -> str:
        """One of KINDS."""
        return self.by

    @property
    def skins(self) -> int:
        """Number of skins; 1 if the contacts apply to any number."""
        return len(self.values)

    def _strength(self) -> str:
        given = [name for name in STRENGTHS if getattr(self, name) is not None]
        if len(given) != 1:
            raise InputError(
                f"PointContacts: takes one of {', '.join(STRENGTHS)}, "
                f"got {' and '.join(given) or 'none'}"
            )
        return given[0]

    def _table(self, strength: ArrayLike) -> Real:
        """Columns x, y, strength, radius, curvature_radius, width and height: (skin, contact, 7).

        A radius that is not given is infinite, a size 0.
        """
        sides = (None, None) if self.size is None else _sides(self.size)
        given = self.x, self.y, strength, self.radius, self.curvature_radius, *sides
        columns = [(k, np.asarray(each)) for k, each in enumerate(given) if each is not None]
        shape = np.broadcast(*(column for _, column in columns)).shape
        if len(shape) > 2:
            raise ValueError(f"shape must be (contact,) or (skin, contact), got {shape}")
        if (count := math.prod(shape[-1:])) > MAX_CONTACTS:
            raise InputError(
                f"PointContacts: a skin has at most {MAX_CONTACTS} contacts, got {count}; join "
                "those that are near each other, or give a PressureImage"
            )
        check_memory(
            COPIES * 8 * len(COLUMNS) * math.prod(shape), f"{shape} contacts", "give fewer"
        )
        table = np.empty(((1, 1)[len(shape) :] + shape) + DEFAULTS.shape)
        table[...] = DEFAULTS
        for k, column in columns:
            table[..., k] = column
        return table


def _sides(size: ArrayLike) -> tuple[Real, Real]:
    sides = np.asarray(size, dtype=np.float64)
    if sides.shape[-1:] != (2,):
        raise ValueError(f"size must have the shape (..., 2), got {sides.shape}")
    return sides[..., 0], sides[..., 1]


def _counts(count: ArrayLike | None, skins: int, contacts: int) -> Integer:
    if count is None:
        return np.full(skins, contacts)
    counts = np.asarray(count)
    if counts.shape != (skins,) or counts.dtype.kind not in "iu":
        raise ValueError(f"count must be a whole number for each of {skins} skins, got {count}")
    if counts.min(initial=0) < 0 or counts.max(initial=0) > contacts:
        raise ValueError(f"count must be in 0..{contacts}, got {count}")
    return counts.astype(np.int64)


@dataclass(frozen=True, eq=False)
class SkinImage:
    """Values on equal rectangles over the whole length and width of the skin.

    `values` has the shape (skin, row, column). kind: one of KINDS.
    """

    kind: ClassVar[str]
    values: Real = field(init=False, repr=False)

    @property
    def skins(self) -> int:
        """Number of skins; 1 if the image applies to any number."""
        return len(self.values)

    def __post_init__(self) -> None:
        name = self.kind.removesuffix(" image")
        given = np.asarray(getattr(self, name))
        check_memory(8 * given.size, f"{given.size} values of {name}", "give a coarser image")
        values = np.asarray(given, dtype=np.float64)
        if values.ndim not in (2, 3) or 0 in values.shape:
            raise InputError(
                f"{type(self).__name__}: {name} must have the shape (row, column) or "
                f"(skin, row, column), got {values.shape}"
            )
        object.__setattr__(self, "values", values if values.ndim == 3 else values[None])


@dataclass(frozen=True, eq=False)
class DepthImage(SkinImage):
    """Indentation of the skin on equal rectangles over its whole length and width.

    Row 0 lies at y = 0, column 0 at x = 0.

    depth: indentation, >= 0, m, shape (row, column) or (skin, row, column). Raises InputError for
    another shape.
    """

    kind = "depth image"
    depth: ArrayLike = field()


@dataclass(frozen=True, eq=False)
class PressureImage(SkinImage):
    """Pressure on the skin on equal rectangles over its whole length and width.

    Row 0 lies at y = 0, column 0 at x = 0.

    pressure: normal to the skin, >= 0, Pa, shape (row, column) or (skin, row, column). Raises
    InputError for another shape.
    """

    kind = "pressure image"
    pressure: ArrayLike = field()


Contacts = PointContacts | DepthImage | PressureImage


@dataclass(frozen=True, eq=False)
class KnownContacts:
    """Contacts of all skins, and what an engine knows of them, which sweeps keep.

    contacts: as a sensor takes them, None for none. touches: x, y [m], force [N] and area [m²] of
    what touches each skin, one array (touch, 4) a skin. beside: force beside each skin, which it
    does not feel, N, (skin,).
    """

    contacts: Contacts | None
    touches: Sequence[Real]
    beside: Sequence[float]
