"""Names of quantities in the tables of other tools: one list per quantity, for all instruments."""

from __future__ import annotations

from collections.abc import Sequence
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
