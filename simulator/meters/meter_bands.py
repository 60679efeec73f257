"""Frequency ranges of LCR meters."""

from __future__ import annotations

from collections.abc import Iterable

from ..sweeps.units import prefixed

METER_BANDS = {
    "IM3523": (40.0, 200e3),
    "IM3533": (1e-3, 200e3),
    "IM3536": (4.0, 8e6),
    "IM3570": (4.0, 5e6),
    "E4980A": (20.0, 2e6),
    "E4980AL": (20.0, 1e6),
    "4284A": (20.0, 1e6),
    "E4990A": (20.0, 120e6),
}
"""Lowest and highest frequency of each model in Hz; source: specifications by Hioki and Keysight.

E4980AL with its option 102, E4990A with its option 120; with another one the meter itself refuses
what it lacks, or is found at another frequency."""
VIRTUAL_MODEL = "IM3523"
"""The model that the virtual meter imitates."""


def outside_band(
    model: str, frequencies: Iterable[float], band: tuple[float, float] | None = None
) -> str:
    """Message with a model's range and the frequencies [Hz] outside it; empty if there are none.

    It names the models that read all of them.

    band: lowest and highest frequency, Hz; default: that of METER_BANDS.
    """
    low, high = band or METER_BANDS[model]
    wanted = list(frequencies)
    outside = [each for each in wanted if not low <= each <= high]
    if not outside:
        return ""
    shown = ", ".join(_hertz(each) for each in outside[:3])
    shown += f" and {len(outside) - 3} more" if len(outside) > 3 else ""
    are = "is" if len(outside) == 1 else "are"
    others = reaching(wanted)
    read_by = f" (within reach of {', '.join(others)})" if others else ""
    return f"meter {model} reads {_hertz(low)} to {_hertz(high)}; {shown} {are} outside{read_by}"


def reaching(frequencies: Iterable[float]) -> list[str]:
    """Models that read all of these frequencies [Hz]."""
    wanted = list(frequencies)
    return [
        model
        for model, (low, high) in METER_BANDS.items()
        if all(low <= each <= high for each in wanted)
    ]


def _hertz(frequency: float) -> str:
    return prefixed(frequency, "Hz")
