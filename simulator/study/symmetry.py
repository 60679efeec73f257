"""Mirror symmetry of a skin: pixels that show the same impedance when pressed.

A skin whose foils and interfaces are unchanged when rows (or columns) are counted from the other
end gives Z of pixel (i, j) at (n + 1 - i, j) as well.
"""

from __future__ import annotations

from collections.abc import Callable

from ..scene.contacts import Contact
from ..scene.scene import Scene

Pixel = tuple[int, int]
"""(row, column), counted from 1; (0, 0) is the skin at rest."""
AT_REST: Pixel = (0, 0)
ACROSS_ROWS: dict[str, str] = {"bottom": "top", "top": "bottom", "left": "left", "right": "right"}
ACROSS_COLUMNS: dict[str, str] = {
    "left": "right",
    "right": "left",
    "bottom": "bottom",
    "top": "top",
}


def representative(scene: Scene) -> Callable[[Pixel], Pixel]:
    """A function from a pixel to the one of lowest row and column that shows the same impedance."""
    rows, columns = scene.pixels.rows, scene.pixels.columns
    rows_alike, columns_alike = (
        _unchanged(scene, mirrored) for mirrored in (ACROSS_ROWS, ACROSS_COLUMNS)
    )

    def of(pixel: Pixel) -> Pixel:
        row, column = pixel
        if pixel == AT_REST:
            return pixel
        return (
            min(row, rows + 1 - row) if rows_alike else row,
            min(column, columns + 1 - column) if columns_alike else column,
        )

    return of


def _unchanged(scene: Scene, mirrored: dict[str, str]) -> bool:
    """Whether every foil has a mirror image, and every interface connects the images alike."""
    names = {_described(contact): contact.name for contact in scene.contacts}
    images = {
        contact.name: names.get(_described(_image(contact, mirrored))) for contact in scene.contacts
    }
    return None not in images.values() and all(
        {images[name] for name in side} == set(side)
        for interface in scene.interfaces
        for side in (interface.high, interface.low)
    )


def _image(contact: Contact, mirrored: dict[str, str]) -> Contact:
    runs_across = mirrored[contact.edge] == contact.edge
    low, high = contact.span
    span = (1 - high, 1 - low) if runs_across else contact.span
    return contact.model_copy(update={"edge": mirrored[contact.edge], "span": span})


def _described(contact: Contact) -> str:
    """All that a contact is, but for its name."""
    return contact.model_copy(update={"name": ""}).model_dump_json()
