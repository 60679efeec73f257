"""Recognizes the quantity, unit and sign of another tool's column by its name."""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

REAL = "re real realpart r"
IMAGINARY = "im imag imaginary img imagpart imaginarypart i"
SIZE = "mod modulus mag magnitude abs absolute absolutevalue"
ANGLE = "phase phaseangle phasedeg theta phi θ φ ϕ arg angle ph phz"
IMPEDANCE, ADMITTANCE = "z impedance", "y admittance"


def _forms(letters: str, parts: str) -> list[str]:
    """All ways to write a part of a complex quantity: `re(z)`, `rez`, `zre`, `z(re)`."""
    return [
        form
        for letter, part in product(letters.split(), parts.split())
        for form in (f"{letter}{part}", f"{part}{letter}", f"{part}({letter})", f"{letter}({part})")
    ]


NAMES: dict[str, Sequence[str]] = {
    "frequency": [
        *"f freq frequency frequencies frequenz fréquence frecuencia frequenza".split(),
        *"周波数 频率 測定周波数 omega ω angularfrequency".split(),
    ],
    "Rs": [
        *"r rs rser resistance seriesresistance rseries esr real re z' zs' z'a z'(a) 抵抗".split(),
        *"zr zsre zsreal".split(),
        *_forms(IMPEDANCE, REAL),
    ],
    "X": [
        *"x xs xser reactance seriesreactance imag im imaginary img z'' zs'' z''b z''(b)".split(),
        *"zi zsim zsimag リアクタンス".split(),
        *_forms(IMPEDANCE, IMAGINARY),
    ],
    "magnitude": [
        *"z |z| modulus magnitude impedance |impedance| インピーダンス 阻抗".split(),
        *_forms(IMPEDANCE, SIZE),
    ],
    "phase": [
        *"phase phaseangle theta phi θ φ ϕ arg angle phz θz thetaz theta-z phaseofz".split(),
        *"位相 位相角 相位 相位角 phasenwinkel".split(),
        *_forms(IMPEDANCE, ANGLE),
    ],
    "G": ["g", "gp", "conductance", "parallelconductance", "y'", *_forms(ADMITTANCE, REAL)],
    "B": ["b", "bp", "susceptance", "parallelsusceptance", "y''", *_forms(ADMITTANCE, IMAGINARY)],
    "admittance": ["y", "|y|", "admittance", "|admittance|", *_forms(ADMITTANCE, SIZE)],
    "admittance phase": ["θy", "thetay", "theta-y", "thy", *_forms(ADMITTANCE, ANGLE)],
    "Cp": "cp cp' cpar cparallel parallelcapacitance".split(),
    "Cs": "cs cs' cser cseries seriescapacitance".split(),
    "Lp": "lp lpar lparallel parallelinductance".split(),
    "Ls": "ls lser lseries seriesinductance".split(),
    "Rp": "rp rpar rparallel parallelresistance".split(),
    "D": [
        *"d df tand tan(d) tanδ tan(δ) tandelta tan(delta) losstangent lossfactor".split(),
        *"dissipation dissipationfactor".split(),
    ],
    "Q": "q qf qfactor qualityfactor".split(),
    "gain": "gain |gain| gainmagnitude v/vs |v/vs| vout/vin |vout/vin|".split(),
    "gain phase": [*_forms("gain", ANGLE), "gainphaseangle", "phaseofgain"],
    "gain real": _forms("gain", REAL),
    "gain imaginary": _forms("gain", IMAGINARY),
}
"""Names in lower case, without spaces, points and underscores."""
LABELS = {
    "sweep": "sweep sweepno sweepnumber",
    "cycle": "cycle cyclenumber",
    "press": "press",
    "row": "row",
    "column": "column col",
    "interface": "interface channel channelno channelnumber channel# ch chno chnumber ch# chan "
    "chan# port portno port# mux muxchannel muxch mux#",
    "session": "session",
    "repetition": "repetition rep repeat",
    "status": "status stat err error errorcode statuscode errcode measstatus "
    "measurementstatus overload overrange ovl",
}
WITHOUT_USUAL_UNIT = {"omega", "ω", "angularfrequency"}
"""Names of a frequency that need a unit, as every angle does."""
QUANTITY_OF = {name: quantity for quantity, names in NAMES.items() for name in names}
LABEL_OF = {name: label for label, listed in LABELS.items() for name in listed.split()}


PREFIXES = {
    "": 0, "f": -15, "p": -12, "n": -9, "u": -6, "m": -3, "k": 3, "K": 3, "M": 6, "G": 9,
}  # fmt: skip
OHM = dict.fromkeys(("ohm", "ohms", "o"), 1.0)
SIEMENS = dict.fromkeys(("s", "siemens", "mho", "ohm-1", "1/ohm", "ohm^-1"), 1.0)
DEGREES = dict.fromkeys(("deg", "degree", "degrees"), math.pi / 180)
ANGLE = {**DEGREES, **dict.fromkeys(("rad", "radian", "radians"), 1.0)}
UNITS = {
    "frequency": {"hz": 1.0, "hertz": 1.0, "rad/s": 1 / (2 * math.pi)},
    **dict.fromkeys(("phase", "admittance phase", "gain phase"), ANGLE),
    **dict.fromkeys(("Rs", "X", "magnitude", "Rp"), OHM),
    **dict.fromkeys(("G", "B", "admittance"), SIEMENS),
    **dict.fromkeys(("Cp", "Cs"), {"f": 1.0, "farad": 1.0}),
    **dict.fromkeys(("Lp", "Ls"), {"h": 1.0, "henry": 1.0}),
    **dict.fromkeys(("D", "Q"), {"u": 1.0, "1": 1.0, "%": 0.01}),
    **dict.fromkeys(("gain", "gain real", "gain imaginary"), {"v/v": 1.0, "1": 1.0, "%": 0.01}),
    "gain level": {"db": 1.0},
}
"""Spellings of units in lower case, and the factor to SI without a prefix."""
WITH_MEGA = ("hz", "hertz", *OHM)
"""Units that M may stand before; nobody measures MF, MH or MS."""
USUAL = {
    **dict.fromkeys(("Rs", "X", "magnitude", "Rp"), "ohm"),
    **dict.fromkeys(("G", "B", "admittance"), "S"),
    **dict.fromkeys(("phase", "admittance phase", "gain phase"), "deg or rad"),
    **dict.fromkeys(("Cp", "Cs"), "F"),
    **dict.fromkeys(("Lp", "Ls"), "H"),
    **dict.fromkeys(("D", "Q"), "a number without unit"),
    **dict.fromkeys(("gain", "gain real", "gain imaginary"), "V/V, % or dB"),
    "gain level": "dB",
    "frequency": "Hz or rad/s",
}
"""Units as messages name them; each but an angle's may have a prefix."""
AMBIGUOUS = ("b", "d", "g", "q", "y")
"""Letters that name a quantity as capitals or with a unit, and anything else without."""
ANGLES = ("phase", "admittance phase", "gain phase")
DECIBELS = ("gain", "magnitude")
"""Quantities whose column in dB holds the level of a gain."""
SPELLINGS = str.maketrans(
    {
        **dict.fromkeys("\N{PRIME}\N{RIGHT SINGLE QUOTATION MARK}\N{ACUTE ACCENT}`", "'"),
        **dict.fromkeys('\N{DOUBLE PRIME}\N{RIGHT DOUBLE QUOTATION MARK}"', "''"),
        **dict.fromkeys("\N{MINUS SIGN}\N{EN DASH}", "-"),
        **dict.fromkeys("\N{OHM SIGN}\N{GREEK CAPITAL LETTER OMEGA}", "ohm"),
        **dict.fromkeys("\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}", "u"),
        **dict.fromkeys("\N{DEGREE SIGN}\N{RING ABOVE}\N{MASCULINE ORDINAL INDICATOR}", "deg"),
    }
)
BOUND = re.compile(r"(?P<name>.+?)\s*(?:\(\s*(?P<a>[^()]*)\)|\[\s*(?P<b>[^\[\]]*)\]|/(?P<c>.+))")
LOOSE = re.compile(r"(?P<name>.+?)(?:\s+in\s+|\s+|_)(?P<unit>[^\s_\d][^\s_]*)")
CURVE = (
    r"(?:trace|channel|chan|ch|run|curve|scan|sweep|series|sample|measurement|meas|set|loop|cycle|"
    r"port|mux|repeat|rep|test|file|no|nr|duplicated)[\s_.#]*"
)
MARKS = [
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        rf"^(?P<mark>{CURVE}\d+|(?:{CURVE})?[a-z](?=\s*:)|\d+(?=\s*:))[\s:._]*(?=\S)",
        r"^(?P<mark>)(?:measured\s|(?:trace|channel|ch)\s*:?\s*)(?=\S)",
        rf"(?P<mark>[\s_.#]+\d+|\s*[(\[]\s*(?:{CURVE})?#?\d+\s*[)\]]|[\s_.-]+{CURVE}\d+)"
        r"(?=$|[\s(\[/_])",
    )
]
"""Marks of one of several curves before and behind a name; words before it that mark none."""
LETTER = re.compile(r"[-\s]*(?P<letter>[rxy])(?![a-z\d'|])", re.IGNORECASE)
PART = re.compile(
    r"(?:impedance|admittance)\s*:\s*(?=(?:[rxcl][sp]|q|d|tan)\b)|gain\s*:\s*(?=mag)", re.IGNORECASE
)
"""The quantity before one of its parts."""
SHOWN = re.compile(r"\s*-\s*data$", re.IGNORECASE)
MAY_BE_FREQUENCY = re.compile(
    "|".join(name for name in NAMES["frequency"] if len(name) > 1 or not name.isascii())
    + r"|(?<![^\W_])f(?![^\W_])",
    re.IGNORECASE,
)
"""Found in every line that names a frequency, and in few others."""
NEGATIVE = re.compile(r"(?:-|(?:neg\.?|negative|minus)\s)\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Column:
    """A column with a recognized name.

    name: as in the file. holds: a key of UNITS or of LABELS. factor: from the file's numbers to SI,
    negative if the file holds the negative quantity. problem: why the numbers cannot be used.
    place: position in a line. curve: mark of one of several curves. unit: one that begins with m
    or M in a name without case; the factor is that of m.
    """

    name: str
    holds: str
    factor: float = 1.0
    problem: str = ""
    place: int = 0
    curve: str = ""
    unit: str = ""

    @property
    def letter(self) -> str:
        """The bare r, x or y that names the quantity, as written; empty for other names."""
        match = LETTER.match(self.name)
        return match["letter"] if match else ""


@functools.lru_cache(4096)
def recognised(name: str, place: int = 0) -> Column | None:
    """The column of that name, or None if the name is unknown."""
    text = spelled(name)
    if _key(text) in LABEL_OF:
        return Column(name, LABEL_OF[_key(text)], place=place)
    found: list[Column] = []
    for mark, bare in [("", text), *_marked(text)]:
        column = _of_quantity(name, bare)
        if column is not None:
            found.append(replace(column, place=place, curve=mark))
    return next((each for each in found if not each.problem), found[0] if found else None)


def _marked(text: str) -> Iterator[tuple[str, str]]:
    """The mark of a curve and the name without it, for each mark that the name may have."""
    for pattern in MARKS:
        for match in pattern.finditer(text):
            yield re.sub(r"[\W_]", "", match["mark"]).casefold(), text.replace(match[0], "", 1)


def _of_quantity(name: str, text: str) -> Column | None:
    """The column of a quantity. text: its spelled name without the mark of a curve."""
    sign, text = _without_sign(SHOWN.sub("", PART.sub("", text)))
    for stem, unit, marked in _splits(text):
        quantity = QUANTITY_OF.get(_key(stem))
        if quantity is None or (stem in AMBIGUOUS and not unit):
            continue
        if quantity in DECIBELS and unit.casefold() == "db":
            quantity = "gain level"
        factor = unit_factor(quantity, unit, _key(stem))
        caseless = factor is None or _without_case(name, unit)
        if caseless and (other := unit_factor(quantity, unit.swapcase(), _key(stem))) is not None:
            milli = min(factor or other, other)
            undecided = unit if factor not in (None, other) else ""
            return Column(name, quantity, sign * milli, unit=undecided)
        if factor is not None:
            return Column(name, quantity, sign * factor)
        if marked:
            return Column(name, quantity, problem=_unit_problem(name, quantity, unit))
    return None


def spelled(name: str) -> str:
    """The name with one spelling of each sign; wide characters become narrow."""
    text = unicodedata.normalize("NFKC", name.strip().translate(SPELLINGS))
    return text.translate(SPELLINGS).strip()


def _without_sign(text: str) -> tuple[float, str]:
    match = NEGATIVE.match(text)
    return (-1.0, text[match.end() :]) if match else (1.0, text)


def _splits(text: str) -> Iterator[tuple[str, str, bool]]:
    """Splits a name into (name, unit, True if the unit is explicit), the most certain first."""
    yield text, "", True
    if (match := BOUND.fullmatch(text)) is not None:
        unit = match["a"] or match["b"] or match["c"] or ""
        if not re.search(r"\w|%", unit):
            yield from list(_splits(match["name"]))[1:]
        yield match["name"], unit, True
    if (match := LOOSE.fullmatch(text)) is not None:
        yield match["name"], match["unit"], False


def _key(name: str) -> str:
    return re.sub(r"[\s_.:]", "", name).casefold().replace("[", "(").replace("]", ")")


def unit_factor(quantity: str, unit: str, key: str = "") -> float | None:
    """Factor from the unit to SI; 1 without a unit unless it is needed; None if unknown."""
    unit = re.sub(r"[\s()\[\]]", "", unit)
    if not unit:
        return None if quantity in ANGLES or key in WITHOUT_USUAL_UNIT else 1.0
    for spelling, factor in UNITS[quantity].items():
        prefix = unit[: len(unit) - len(spelling)]
        known = prefix in PREFIXES and (prefix != "M" or spelling in WITH_MEGA)
        if known and unit.casefold() == prefix.casefold() + spelling:
            return factor * 10.0 ** PREFIXES[prefix]
    return None


def _without_case(name: str, unit: str) -> bool:
    """True if a program may have written all letters of a unit small, or all as capitals."""
    unit = unit.strip(" ()[]")
    written = name.islower() or name.isupper() or unit[1:] in ("hz", "HZ", "OHM", "OHMS")
    return written and (unit.islower() or unit.isupper())


def _unit_problem(name: str, quantity: str, unit: str) -> str:
    got = f"got {unit!r}" if unit else "but it names none"
    return f"column `{name}` must be in {USUAL[quantity]}, {got}"
