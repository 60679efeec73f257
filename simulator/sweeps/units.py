"""Units and accuracies as texts."""

from __future__ import annotations

import math
import re
from decimal import Decimal, DecimalException

CHANGES = "changes from the unpressed skin"
NOISE, NOISE_FREE = "with the meter's noise", "free of noise (a meter finds fewer)"
FOUND = {
    "pair": "none to two pixels were all found",
    "touches": "number of touches was found",
}


def bound_text(baseline_count: int, skins: str) -> str:
    """The line that explains a bound.

    baseline_count: number of baseline sweeps, 0 for none. skins: which skins are known.
    """
    features = (
        f"{CHANGES} (mean of {baseline_count} sweeps)"
        if baseline_count
        else "readings without a baseline, with the meter's errors of a session"
    )
    return (
        f"at most means: share of presses that the best localizer of {skins} finds, from "
        f"{features}, with the meter's noise; rcskin study computes what a trained localizer "
        "reaches on other skins"
    )


def accuracy_text(
    target: str, features: str, scored: str, scene: str = "SCENE", *, noisy: bool = True
) -> str:
    """The line that explains an accuracy.

    features: what was evaluated. scored: which sweeps, such as "sweeps outside the training".
    scene: name or path, for the command that computes the bound. noisy: True if a real or
    simulated meter read the sweeps.
    """
    found = FOUND.get(target, f"{target} was found")
    return (
        f"accuracy means: share of the {scored} whose {found}, from {features}, "
        f"{NOISE if noisy else NOISE_FREE}; rcskin limits {scene} computes the bound for a known "
        "skin"
    )


PREFIXES = {"f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "m": -3, "c": -2}
PREFIXES |= {"k": 3, "K": 3, "M": 6, "G": 9}
BASES = ("m", "ohm", "Ω", "F", "Hz", "H", "Pa", "N", "rad", "s", "V", "A")
NUMBER_WITH_UNIT = re.compile(
    r"(?P<number>[-+]?[\d._]+(?:,\d+)?(?:[eE][-+]?\d+)?)\s*(?P<unit>[^\d\s,][^,]*)?"
)

PLAIN_NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)


def plain_number(text: str) -> float:
    """The value of a decimal number with a point; NaN for any other text.

    Python would also read `1_0`, `nan`, `inf` and the digits of other scripts.
    """
    return float(text) if PLAIN_NUMBER.fullmatch(text) else math.nan


def in_si(text: str) -> str | None:
    """The number in SI without its unit, with a point; None if it is plain or not a number."""
    match = NUMBER_WITH_UNIT.fullmatch(text.strip())
    if match is None or (match["unit"] is None and "," not in match["number"]):
        return None
    parts = _parts((match["unit"] or "").strip())
    if parts is None:
        return None
    try:
        number = Decimal(match["number"].replace(",", ".").replace("_", "")).scaleb(parts[0])
    except DecimalException:
        return None
    return f"{float(number):g}"


def quantity(text: str, unit: str | None = "") -> float:
    """The number of a text in a unit: "10 kHz" is 10000 in Hz, "0.5cm" is 5 in mm.

    A number without a unit is in that unit already. unit: empty for a number without a unit, None
    for a number of any unit in SI. Raises ValueError for other text and for another unit.
    """
    try:
        return float(text)
    except ValueError:
        match = NUMBER_WITH_UNIT.fullmatch(text.strip())
    wanted, of = _parts(unit or "") or (0, "")
    power, base = (match and _parts((match["unit"] or "").strip())) or (None, "")
    if power is None or not (
        unit is None or base in (of, of.partition("/")[0]) or (base == "" and wanted == 0)
    ):
        raise ValueError(f"no number in {unit}: {text!r}")
    assert match is not None
    try:
        number = Decimal(match["number"].replace(",", ".").replace("_", ""))
    except DecimalException as error:
        raise ValueError(str(error)) from error
    return float(number.scaleb(power - wanted))


def suggestion(text: str) -> str:
    """`; did you mean NUMBER?` for a number with a unit or a comma; empty for other text."""
    plain = in_si(text)
    return "" if plain is None else f"; did you mean {plain}?"


def _parts(unit: str) -> tuple[int, str] | None:
    """Power of ten of an SI unit with its prefix, or of a prefix alone, and the unit without it.

    None if it is unknown. Hz may be written in any case.
    """
    above, slash, below = re.sub("hz$", "Hz", unit, flags=re.IGNORECASE).partition("/")
    if above == "%":
        return -2, slash + below
    power = 0 if above in ("", *BASES) else PREFIXES.get(above[0])
    base = above if above in ("", *BASES) else above[1:]
    if power is None or base not in ("", *BASES):
        return None
    return power, f"{base.replace('Ω', 'ohm')}{slash}{below}"


PREFIX_OF_POWER = {0: "", 3: "k", 6: "M", 9: "G", -3: "m", -6: "u", -9: "n", -12: "p", -15: "f"}


def prefixed(value: float, unit: str) -> str:
    """A number with three digits, its unit and a suitable SI prefix: 5.46 kHz."""
    power = 3 * math.floor(math.log10(abs(value)) / 3 + 1e-12) if value else 0
    power = min(max(power, min(PREFIX_OF_POWER)), max(PREFIX_OF_POWER))
    return f"{value / 10.0**power:.3g} {PREFIX_OF_POWER[power]}{unit}"
