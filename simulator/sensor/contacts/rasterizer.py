"""Contacts of a moment as cells of a grid and rises of c there, and why a scene refuses some."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Mask, Real
from ...compiled import compiled
from ...mesh.pixel_coverage import with_fingers_at
from ...models.mechanics.deformation import check_plane
from ...models.mechanics.foam_law import FoamTables, foam_tables, rise_at, strain_under
from ...models.reduced.touches import spreads
from ...press.batch import NOTHING, PressBatch
from ...press.cell_kernel import FAINT, axis_shares
from ...press.finger import finger_over
from ...press.pixels import SAMPLES, GridCells
from ...press.rasterized import TouchBatch
from ...scene.parts import Plan, Pressing, Skin
from ...scene.planar import shared
from ...scene.supports import require
from ...sweeps import InputError
from ...sweeps.press_text import MAX_FACTOR, MIN_FACTOR
from ..cell_spreading import PARTS, CellSpreading
from .contact_types import KINDS, STRENGTHS, Contacts, DepthImage, PointContacts, PressureImage
from .patch_kernel import (
    ADDED,
    BAD_PATCH,
    BAD_PLACE,
    BAD_STRENGTH,
    FACTOR,
    FINE,
    Fault,
    Stacks,
    winkler_stacks,
)
from .stack_kernel import cells_of_stacks, moments_of_stacks, pressed_moments

if TYPE_CHECKING:
    from .spread_contacts import SpreadContacts

NO_PATCHES = np.zeros((0, 0))
TooDeep = Literal["limit", "refuse"]
RasterizedPoints = tuple[PressBatch, Mask, Real, Fault]
"""Presses; True for limited ones; radius of each patch, m; the first invalid contact."""


class ContactCells(NamedTuple):
    """Contacts as cells of a grid, and presses whose foam was limited to its largest strain.

    batch: one press if the contacts apply to any skin, else one of each skin. limited: shape
    (press,). patches: radius under each contact, m, (press, contact); 0 for rectangles; empty for
    images.
    """

    batch: PressBatch
    limited: Mask
    patches: Real = NO_PATCHES


@dataclass(frozen=True, eq=False)
class ContactRasterizer:
    """Turns contacts into cells of a grid and rises of c there, for one scene.

    grid: rows and columns of cells. coarse: rows and columns of coarser cells, on which the rises
    are spread so that moments are kept, see `cell_spreading`; None for rises in the cells of
    `grid`. too_deep: "limit" compresses foam at most to its largest strain, and
    `ContactCells.limited` says so; "refuse" raises InputError.
    """

    skin: Skin
    pressing: Pressing
    grid: tuple[int, int]
    coarse: tuple[int, int] | None
    too_deep: TooDeep
    foam: FoamTables
    cells: GridCells
    refusals: dict[str, str]
    spread: SpreadContacts | None
    spreading: CellSpreading | None

    @classmethod
    def of(
        cls,
        skin: Skin,
        pressing: Pressing,
        grid: tuple[int, int] | None = None,
        too_deep: TooDeep = "limit",
        coarse: tuple[int, int] | None = None,
        highest: float = np.inf,
    ) -> ContactRasterizer:
        """Rasterizer on a grid (rows, columns), by default the scene's pixels.

        coarse: rows and columns of coarser cells; `grid` divides each into PARTS along its sides.
        highest: factor on c beyond which foam counts as too deep, if its own law goes further.
        """
        if too_deep not in ("limit", "refuse"):
            raise InputError(f"too_deep must be 'limit' or 'refuse', got {too_deep!r}")
        grid = grid or skin.pixels.shape
        foam, cells = foam_tables(skin.foam, highest), GridCells.on(skin, grid)
        refused, spread = refusals(skin, pressing), None
        if spreads(skin) and "force" not in refused:
            from .spread_contacts import SpreadContacts

            spread = SpreadContacts(skin, grid, foam, cells)
        spreading = CellSpreading(coarse, PARTS) if coarse else None
        return cls(skin, pressing, grid, coarse, too_deep, foam, cells, refused, spread, spreading)

    def __call__(self, contacts: Contacts) -> ContactCells:
        """Cells and rises of contacts.

        Raises InputError for contacts that are invalid or that the scene does not take.
        """
        if contacts.kind in self.refusals:
            raise InputError(self.refusals[contacts.kind])
        found = (
            self._points(contacts) if isinstance(contacts, PointContacts) else self._image(contacts)
        )
        if self.too_deep == "refuse" and found.limited.any():
            raise InputError(too_deep_message(self.skin, contacts, found.limited))
        return found

    def _points(self, contacts: PointContacts) -> ContactCells:
        if self.spread is not None and contacts.by != "factor":
            batch, limited, patches, fault = self._spread_points(self.spread, contacts)
        else:
            batch, limited, patches, fault = self._points_alone(contacts)
        if fault[2] != FINE:
            raise InputError(invalid_contact(self.skin, contacts, *fault))
        if self.pressing.finger:
            none = PressBatch.of([NOTHING] * contacts.skins)
            fine = with_fingers(self.skin, self.pressing, contacts, none, patches, self.grid)
            batch = batch.and_(self._on_coarse(fine))
        return ContactCells(batch, limited, patches)

    def _points_alone(self, contacts: PointContacts) -> RasterizedPoints:
        """Contacts of which each presses its patch alone."""
        by, added = STRENGTHS.index(contacts.by), self.pressing.adds is not None
        by = ADDED if by == FACTOR and added else by
        given = contacts.values, contacts.counts, by, self.foam, self.cells
        if self.coarse is not None:
            return pressed_moments(*given[:3], tuple(self.foam), tuple(self.cells), self.coarse)
        stacks, limited, patches, fault = winkler_stacks(*given)
        return self._of_stacks(contacts, by, stacks, limited), limited, patches, fault

    def _spread_points(self, spread: SpreadContacts, contacts: PointContacts) -> RasterizedPoints:
        """Contacts on skins with tension."""
        stacks, limited, patches, fault, on_lattice = spread.points(contacts)
        batch = self._of_stacks(contacts, ADDED, stacks, limited)
        if on_lattice:
            fine = PressBatch.of(on_lattice.get(k, NOTHING) for k in range(batch.count))
            batch = batch.and_(self._on_coarse(fine))
        return batch, limited, patches, fault

    def _of_stacks(
        self, contacts: PointContacts, by: int, stacks: Stacks, limited: Mask
    ) -> PressBatch:
        given = contacts.values, contacts.counts, by, stacks, limited, self.foam, self.cells
        if self.coarse is not None:
            return moments_of_stacks(*given, self.coarse)
        return cells_of_stacks(*given)

    def _on_coarse(self, fine: PressBatch) -> PressBatch:
        return fine if self.spreading is None else self.spreading(fine)

    def _image(self, image: DepthImage | PressureImage) -> ContactCells:
        by_pressure = isinstance(image, PressureImage)
        if by_pressure and self.spread is not None:
            if (bad := ~((image.values >= 0) & (image.values < np.inf))).any():
                raise InputError(invalid_value(image, *np.argwhere(bad)[0].tolist()))
            each = [self.spread.under_pressure(image, skin) for skin in range(image.skins)]
            batch = PressBatch.of(touched for touched, _ in each)
            return ContactCells(self._on_coarse(batch), np.array([limited for _, limited in each]))
        rises, limited, bad = image_rises(image.values, by_pressure, self.foam)
        if bad[0] >= 0:
            raise InputError(invalid_value(image, *bad))
        return ContactCells(self._of_image(rises), limited)

    def _of_image(self, rises: Real) -> PressBatch:
        """Rises of images, shape (press, row, column), on cells: sums along rows and columns."""
        grid, own = self.coarse or self.grid, image_shares if self.coarse else image_means
        across, along = (own(n, count) for n, count in zip(rises.shape[1:], grid, strict=True))
        found = across @ rises @ along.T
        if self.coarse is None and not self.cells.whole:
            row, column = (
                (2 * np.arange(count * SAMPLES) + 1).reshape(-1, SAMPLES)
                * n
                // (2 * count * SAMPLES)
                for n, count in zip(rises.shape[1:], grid, strict=True)
            )
            i, j = np.nonzero(self.cells.cut >= 0)
            there, mask = self.cells.part[i, j], self.cells.mask[self.cells.cut[i, j]]
            for image, mean in zip(rises, found, strict=True):
                on_skin = np.where(mask, image[row[i][:, :, None], column[j][:, None]], 0.0)
                mean[i, j] = on_skin.mean(axis=(1, 2)) / np.where(there > 0, there, np.inf)
        return PressBatch.on_grid(np.where(abs(found) > FAINT, found, 0.0).reshape(len(found), -1))


@compiled()
def image_rises(
    images: NDArray, by_pressure: bool, foam: FoamTables
) -> tuple[NDArray, NDArray, tuple[int, int, int]]:
    """Rises of c at depths in m or pressures in Pa, shape (press, row, column).

    Last are True for presses whose foam was limited, and press, row and column of the first invalid
    value, -1 if there is none.
    """
    rises, limited = np.zeros(images.shape), np.zeros(len(images), np.bool_)
    for press in range(len(images)):
        for i in range(images.shape[1]):
            for j in range(images.shape[2]):
                value = images[press, i, j]
                if value == 0.0:
                    continue
                if not 0.0 < value < np.inf:
                    return rises, limited, (press, i, j)
                if by_pressure:
                    limited[press] |= value > foam.closed
                    strain = strain_under(foam, min(value, foam.closed))
                else:
                    strain = value / foam.thickness
                    limited[press] |= strain > foam.greatest
                rises[press, i, j] = rise_at(foam, min(strain, foam.greatest))
    return rises, limited, (-1, -1, -1)


@lru_cache(maxsize=16)
def image_means(pixels: int, cells: int) -> Real:
    """Fraction of each cell along an axis in each pixel of an image, shape (cell, pixel)."""
    return shared(np.arange(pixels + 1.0) * cells, np.arange(cells + 1.0) * pixels).T


@lru_cache(maxsize=16)
def image_shares(pixels: int, cells: int) -> Real:
    """Shares of pixels along an axis in coarse cells, which keep moments, shape (cell, pixel)."""
    parts = math.ceil(PARTS * cells / pixels)
    extent = cells / (pixels * parts)
    found = np.zeros((cells + 2, pixels))
    for k in range(pixels * parts):
        first, *shares = axis_shares((k + 0.5) * extent, cells, extent)
        found[first + 1 : first + 4, k // parts] += extent * np.array(shares)
    return found[1:-1]


def to_cells(
    skin: Skin, pressing: Pressing, grid: tuple[int, int], contacts: Contacts
) -> PressBatch:
    """Cells of a grid (rows, columns) that contacts press, and the rises of c there.

    Foam is compressed at most to its largest strain. `ContactRasterizer` is faster for many calls.
    Raises InputError for contacts that are invalid or that the scene does not take.
    """
    return _rasterizer(skin, pressing, grid)(contacts).batch  # pyright: ignore[reportArgumentType]


@lru_cache(maxsize=8)
def _rasterizer(skin: Skin, pressing: Pressing, grid: tuple[int, int]) -> ContactRasterizer:
    return ContactRasterizer.of(skin, pressing, grid)


def with_fingers(
    skin: Skin,
    pressing: Pressing,
    contacts: PointContacts,
    batch: PressBatch,
    outer: Real,
    grid: tuple[int, int],
) -> PressBatch:
    """Presses with the scene's finger on the patch of each contact, as parts of M that rise by F.

    outer: radius of each patch, m, shape (press, contact); 0 for rectangles.
    """
    x, y, _, _, _, width, height = np.moveaxis(contacts.values, -1, 0)
    disc = outer > 0
    width, height = np.where(disc, 2 * outer, width), np.where(disc, 2 * outer, height)
    left, right = (np.clip(x + side * width / 2, 0.0, skin.length) for side in (-1, 1))
    low, high = (np.clip(y + side * height / 2, 0.0, skin.width) for side in (-1, 1))
    area = np.where(disc, np.pi * outer**2, (right - left) * (high - low))
    finger = np.where(area > 0, finger_over(skin, area, pressing.finger), 0.0)
    touches = TouchBatch(contacts.counts, disc, x, y, width, height, np.ones(x.shape), finger)
    return with_fingers_at(skin, batch, touches, grid)


UNITS = {"force": "N", "depth": "m", "factor": "times the unpressed capacitance", "pressure": "Pa"}
MECHANICS = (
    "the foam's law: thickness in [skin.foam], and modulus in [skin.foam.mechanics], with porosity "
    "and solid_permittivity there or relative_permittivity in [skin.foam]"
)


def refusals(skin: Skin, pressing: Pressing) -> dict[str, str]:
    """Reason for each kind of contacts that a scene does not take."""
    found = {}
    for kind in KINDS:
        try:
            _check_kind(skin, pressing, kind)
        except InputError as error:
            found[kind] = str(error)
    return found


def _check_kind(skin: Skin, pressing: Pressing, kind: str) -> None:
    foam, what = skin.foam, f"contacts by {kind}"
    plan = Plan(press=pressing)
    if kind.endswith("image"):
        require("images of contacts", skin, None, plan, called=what)
    require("contacts on a sensor", skin, called=what)
    if kind == "factor":
        return
    require("contacts on a sensor by force, depth or pressure", skin, None, plan, called=what)
    if kind.startswith("depth") and foam.thickness is None:
        raise InputError(f"{skin.name}: {what} need `skin.foam.thickness`")
    if not kind.startswith("depth") and foam.mechanics is None:
        other = ", or factor instead of force" if kind == "force" else ""
        raise InputError(f"{skin.name}: {what} need {MECHANICS}{other}")
    check_plane(skin)


def invalid_contact(
    skin: Skin, contacts: PointContacts, number: int, contact: int, reason: int
) -> str:
    """Message about one contact. reason: number from `patch_kernel`."""
    x, y, strength, radius, curvature, width, height = contacts.values[number, contact].tolist()
    where = f"contact {contact}" + (f" of skin {number}" if contacts.skins > 1 else "")
    length, across = skin.sides
    if reason == BAD_PLACE:
        return (
            f"{where}: (x, y) must lie within 0..{length:g} and 0..{across:g} m on {skin.name}, "
            f"got ({x:g}, {y:g})"
        )
    if reason == BAD_STRENGTH:
        allowed = f"in {MIN_FACTOR:g}..{MAX_FACTOR:g}" if contacts.by == "factor" else ">= 0"
        return f"{where}: {contacts.by} must be {allowed} {UNITS[contacts.by]}, got {strength:g}"
    if reason == BAD_PATCH:
        if contacts.size is not None:
            return f"{where}: size must be > 0 m, got ({width:g}, {height:g})"
        if contacts.by == "factor":
            return f"{where}: a factor needs a finite radius > 0 m, got {radius:g}"
        return (
            f"{where}: radius and curvature_radius must be > 0 m and one of them finite, got "
            f"{radius:g} and {curvature:g}"
        )
    return f"{where}: no skin of {skin.name} lies under the patch at ({x:g}, {y:g}) m"


def invalid_value(contacts: Contacts, number: int, row: int, column: int) -> str:
    """Message about one value of an image."""
    where = f"{type(contacts).__name__}" + (f" of skin {number}" if contacts.skins > 1 else "")
    name = contacts.kind.removesuffix(" image")
    value = contacts.values[number, row, column]
    here = f"row {row} and column {column}"
    return f"{where}: {name} must be >= 0 {UNITS[name]}, got {value:g} in {here}"


def too_deep_message(skin: Skin, contacts: Contacts, limited: Mask) -> str:
    """Message about contacts that would compress the foam further than it can be."""
    foam = skin.foam
    which = f" on skin {int(limited.argmax())}" if contacts.skins > 1 else ""
    return (
        f"{skin.name}: contacts by {contacts.kind}{which} must leave foam of {foam.thickness:g} m "
        f"compressed by at most {foam.greatest_strain:.3g} of its thickness"
    )
