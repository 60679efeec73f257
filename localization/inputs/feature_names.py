"""Names of features of sweeps, for each kind of readings."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass

from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import (
    GAIN,
    IMPEDANCE,
    MAGNITUDE,
    ReadingKind,
    kind_of,
)

PAPER = ("Rs", "Cp")
"""The paper's choice, and the default where the unpressed skin was not measured."""


@dataclass(frozen=True)
class FeatureNames:
    """Names of the features of one kind of readings.

    read: readings as the sweeps store them, in SI units. absolute: logarithm of the magnitude, and
    phase in rad. relative: both relative to recent baseline sweeps of the same session; the meter's
    errors of the session and most differences between skins cancel. baseline: both of the unpressed
    skin at the start of the session; they identify the skin. default: without a baseline.
    """

    read: tuple[str, ...]
    absolute: tuple[str, ...]
    relative: tuple[str, ...]
    baseline: tuple[str, ...]
    default: tuple[str, ...]

    @property
    def all(self) -> tuple[str, ...]:
        """All names."""
        return *self.read, *self.absolute, *self.relative, *self.baseline


OF_IMPEDANCE = FeatureNames(
    ("Rs", "X", "Cp"), ("lnZ", "phase"), ("dlnZ", "dphase"), ("lnZ0", "phase0"), PAPER
)
OF_GAIN = FeatureNames(
    ("gain",), ("lnG", "phaseG"), ("dlnG", "dphaseG"), ("lnG0", "phaseG0"), ("lnG", "phaseG")
)
OF_MAGNITUDE = FeatureNames(("gain",), ("lnG",), ("dlnG",), ("lnG0",), ("lnG",))
NAMES = {IMPEDANCE.name: OF_IMPEDANCE, GAIN.name: OF_GAIN, MAGNITUDE.name: OF_MAGNITUDE}

READ = (*OF_IMPEDANCE.read, *OF_GAIN.read)
ABSOLUTE = (*OF_IMPEDANCE.absolute, *OF_GAIN.absolute)
RELATIVE = (*OF_IMPEDANCE.relative, *OF_GAIN.relative)
BASELINE = (*OF_IMPEDANCE.baseline, *OF_GAIN.baseline)
"""Names of all kinds; the last three have the same order of quantities."""
QUANTITIES = (*READ, *ABSOLUTE, *RELATIVE, *BASELINE)


def names_of(variables: Container[object]) -> FeatureNames:
    """Names of the features of sweeps with variables of these names."""
    return NAMES[kind_of(variables).name]


def names_beside(quantities: Sequence[str]) -> FeatureNames:
    """Names of the kind of readings that some features are of."""
    return OF_GAIN if set(quantities) & set(OF_GAIN.all) else OF_IMPEDANCE


def are_changes(quantities: Sequence[str]) -> bool:
    """True if these features are all changes from the unpressed skin, and nothing else."""
    return tuple(quantities) in [each.relative for each in NAMES.values()]


def check_kind(quantities: Sequence[str], kind: ReadingKind) -> None:
    """Raises InputError for a feature that readings of a kind do not have."""
    allowed = NAMES[kind.name].all
    for name in quantities:
        if name not in allowed:
            needed = "impedance" if name in OF_IMPEDANCE.all else "complex gain"
            raise InputError(
                f"the feature {name} needs the {needed}, and the sweeps hold the {kind.name}; "
                f"choose of {', '.join(allowed)}"
            )
