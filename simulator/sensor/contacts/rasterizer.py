"""Contacts of a moment as cells of a grid and rises of c."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ...arrays import Mask, Real
from ...models.mechanics.foam_law import FoamTables, foam_tables
from ...models.reduced.indentation.indentation_draws import spreads
from ...press.batch import NOTHING, PressBatch
from ...press.pixels import GridCells
from ...scene.parts import Pressing, Skin
from ...sweeps import InputError
from ..cell_spreading import PARTS, CellSpreading
from .contact_types import STRENGTHS, Contacts, PointContacts, PressureImage
from .fingers import with_fingers
from .patch_kernel import ADDED, FACTOR, FINE, Fault, Stacks
from .refusals import invalid_contact, invalid_value, refusals, too_deep_message

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
            from .moment_kernel import pressed_moments

            return pressed_moments(*given, self.coarse)
        from .winkler_kernel import winkler_stacks

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
            from .moment_kernel import moments_of_stacks

            return moments_of_stacks(*given, self.coarse)
        from .stack_kernel import cells_of_stacks

        return cells_of_stacks(*given)

    def _on_coarse(self, fine: PressBatch) -> PressBatch:
        return fine if self.spreading is None else self.spreading(fine)

    def _image(self, contacts: Contacts) -> ContactCells:
        from .image_kernel import imaged_cells

        by_pressure = isinstance(contacts, PressureImage)
        if by_pressure and self.spread is not None:
            return self._spread_image(contacts)
        grid, moments = self.coarse or self.grid, self.coarse is not None
        batch, limited, fault = imaged_cells(
            contacts.values, by_pressure, self.foam, self.cells, grid, moments
        )
        if fault[3] != FINE:
            raise InputError(invalid_value(contacts, *fault[:3]))
        return ContactCells(batch, limited)

    def _spread_image(self, image: PressureImage) -> ContactCells:
        assert self.spread is not None
        bad = ~((image.values >= 0) & (image.values < np.inf))
        if bad.any():
            raise InputError(invalid_value(image, *np.argwhere(bad)[0].tolist()))
        each = [self.spread.under_pressure(image, skin) for skin in range(image.skins)]
        batch = PressBatch.of(touched for touched, _ in each)
        return ContactCells(self._on_coarse(batch), np.array([limited for _, limited in each]))


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
