"""Recognizes the quantity, unit and sign of another tool's column by its name."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

PREFIXES = {
    "": 0, "f": -15, "p": -12, "n": -9, "u": -6, "m": -3, "k": 3, "K": 3, "M": 6, "G": 9,
}  # fmt: skip
UNITS = {
    "frequency": {"hz": 1.0, "hertz": 1.0, "rad/s": 1 / (2 * math.pi)},
    "phase": {
        **dict.fromkeys(("deg", "degree", "degrees"), math.pi / 180),
        **dict.fromkeys(("rad", "radian", "radians"), 1.0),
    },
    **{name: {"ohm": 1.0, "ohms": 1.0} for name in ("Rs", "X", "magnitude")},
    **{name: {"f": 1.0, "farad": 1.0} for name in ("Cp", "Cs")},
}
"""Spellings of units in lower case, and the factor to SI without a prefix."""
NAMES = {
    "frequency": "f freq frequency",
    "Rs": "r rs rser z' zre zreal re(z) rez real(z) realz z(real) zr resistance",
    "X": "x xs xser z'' zim zimag im(z) imz imag(z) imagz z(imag) zi reactance",
    "magnitude": "z |z| zmod absz abs(z) mag(z) magnitude modulus impedance",
    "Cp": "cp cpar cparallel parallelcapacitance",
    "Cs": "cs cser cseries seriescapacitance",
}
NAMES_WITHOUT_USUAL_UNIT = {
    "frequency": "omega ω angularfrequency",
    "phase": "phase theta phi θ φ ϕ arg arg(z) phz zphz zphase phasez phase(z) phaseangle",
}
LABELS = {
    "sweep": "sweep sweepno sweepnumber cycle cyclenumber",
    "press": "press",
    "row": "row",
    "column": "column col",
    "interface": "interface",
    "session": "session",
    "repetition": "repetition rep repeat",
}
QUANTITY_OF = {
    name: quantity
    for names in (NAMES, NAMES_WITHOUT_USUAL_UNIT)
    for quantity, listed in names.items()
    for name in listed.split()
}
UNIT_NEEDED = {name for listed in NAMES_WITHOUT_USUAL_UNIT.values() for name in listed.split()}
LABEL_OF = {name: label for label, listed in LABELS.items() for name in listed.split()}
SPELLINGS = str.maketrans(
    {
        **dict.fromkeys("\N{PRIME}\N{RIGHT SINGLE QUOTATION MARK}\N{ACUTE ACCENT}`", "'"),
        **dict.fromkeys('\N{DOUBLE PRIME}\N{RIGHT DOUBLE QUOTATION MARK}"', "''"),
        **dict.fromkeys("\N{MINUS SIGN}\N{EN DASH}", "-"),
        **dict.fromkeys("\N{OHM SIGN}\N{GREEK CAPITAL LETTER OMEGA}", "ohm"),
        **dict.fromkeys("\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}", "u"),
        "\N{DEGREE SIGN}": "deg",
    }
)
BOUND = re.compile(r"(?P<name>.+?)\s*(?:\(\s*(?P<a>[^()]*)\)|\[\s*(?P<b>[^\[\]]*)\]|/(?P<c>.+))")
LOOSE = re.compile(r"(?P<name>.+?)(?:\s+in\s+|\s+|_)(?P<unit>[^\s_]+)")


@dataclass(frozen=True)
class Column:
    """A column with a recognized name.

    name: as in the file. holds: a key of UNITS or LABELS. factor: from the file's numbers to SI,
    negative if the file holds the negative quantity. problem: why the numbers cannot be used.
    """

    name: str
    holds: str
    factor: float = 1.0
    problem: str = ""


def recognised(name: str) -> Column | None:
    """The column of that name, or None if the name is unknown."""
    text = name.strip().translate(SPELLINGS)
    if _key(text) in LABEL_OF:
        return Column(name, LABEL_OF[_key(text)])
    sign, text = (-1.0, text[1:]) if text.startswith("-") else (1.0, text)
    for stem, unit, marked in _splits(text):
        quantity = QUANTITY_OF.get(_key(stem))
        if quantity is None:
            continue
        factor = _factor(quantity, unit, _key(stem) in UNIT_NEEDED)
        if factor is not None:
            return Column(name, quantity, sign * factor)
        if marked:
            return Column(name, quantity, problem=_unit_problem(name, quantity, unit))
    return None


def _splits(text: str) -> list[tuple[str, str, bool]]:
    """Splits a name into (name, unit, True if the unit is explicit), the most certain first."""
    found = [(text, "", True)]
    if (match := BOUND.fullmatch(text)) is not None:
        found.append((match["name"], match["a"] or match["b"] or match["c"] or "", True))
    if (match := LOOSE.fullmatch(text)) is not None:
        found.append((match["name"], match["unit"], False))
    return found


def _key(name: str) -> str:
    return re.sub(r"[\s_.]", "", name).casefold()


def _factor(quantity: str, unit: str, needed: bool) -> float | None:
    """Factor from the unit to SI; 1 without a unit unless it is needed; None if unknown."""
    unit = re.sub(r"[\s()]", "", unit)
    if not unit:
        return None if needed else 1.0
    for spelling, factor in UNITS[quantity].items():
        prefix = unit[: len(unit) - len(spelling)]
        if unit.casefold() == prefix.casefold() + spelling and prefix in PREFIXES:
            return factor * 10.0 ** PREFIXES[prefix]
    return None


def _unit_problem(name: str, quantity: str, unit: str) -> str:
    got = f"got {unit!r}" if unit else "but it names none"
    return f"column `{name}` must be in {' or '.join(UNITS[quantity])}, {got}"
