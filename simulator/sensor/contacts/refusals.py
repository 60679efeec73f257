"""Messages about contacts that are invalid, or that a scene does not take."""

from __future__ import annotations

from ...arrays import Mask
from ...models.mechanics.deformation import check_plane
from ...press.walls import require_no_walls
from ...scene.parts import Pressing, Skin
from ...sweeps import InputError
from ...sweeps.press_text import MAX_FACTOR, MIN_FACTOR
from .contact_types import KINDS, Contacts, PointContacts

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
    if kind.endswith("image") and pressing.finger:
        raise InputError(
            f"{skin.name}: {what} cannot be fingers; leave out `press.finger` or use PointContacts"
        )
    require_no_walls(skin, what)
    if kind == "factor":
        return
    if pressing.adds:
        raise InputError(
            f"{skin.name}: {what} press no foam, touches add a capacitance to earth here "
            "(`press.adds`); use PointContacts with factor = 1 + capacitance / unpressed "
            "capacitance of the patch"
        )
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
    from .patch_kernel import BAD_PATCH, BAD_PLACE, BAD_STRENGTH

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
