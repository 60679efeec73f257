"""Facts about the readers of gains of a scene, with the unpressed skin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..models.solver import Solver
from ..press.press import Press
from ..scene.contacts import Interface
from ..scene.meter_tables import Converter
from ..scene.parts import SceneParts
from ..scene.readers import Load, Source
from ..sweeps.errors import ToleranceError
from ..sweeps.units import prefixed

RTOL = 1e-3


def describe_gains(parts: SceneParts) -> Iterator[str]:
    """A sentence on the reader of each interface, then one on gains of the unpressed skin."""
    what = "complex gain" if parts.setup.phases else "magnitude of the gain"
    for each in parts.setup.interfaces:
        assert each.series_resistance is not None
        through = prefixed(each.series_resistance, "ohm")
        yield (
            f"{each.name}: reads the {what}, driven through {through}{_scale(each)}; "
            f"{_input(each.load)}{_together(each)}"
        )
    try:
        gain = np.abs(Solver(parts, RTOL).solve(Press()).Z)
    except ToleranceError as error:
        yield f"of the unpressed skin: not found, {error}"
        return
    ends = " and ".join(prefixed(f, "Hz") for f in parts.setup.frequency[[0, -1]])
    for each, own in zip(parts.setup.interfaces, gain, strict=True):
        yield f"{each.name}: unpressed {own[0]:.3g} and {own[-1]:.3g} at {ends}"


def describe_converter(converter: Converter) -> str:
    """Noise of a converter in words."""
    share = 100 * converter.smallest_deviation
    return (
        f"{prefixed(converter.component_noise, 'V')} of each component of a node's voltage, "
        f"{share:.3g} % of a gain of 1 and {10 * share:.3g} % of one of 0.1"
    )


def _scale(interface: Interface) -> str:
    a = interface.source_scale
    return "" if a == 1 else f" by {a:.4g} times the voltage that readings are divided by"


def _input(load: Load | None) -> str:
    parts = [] if load is None or load.resistance is None else [prefixed(load.resistance, "ohm")]
    parts += [prefixed(load.capacitance, "F")] if load is not None and load.capacitance else []
    return f"the input has {' in parallel with '.join(parts)}" if parts else "the input is no load"


def _together(interface: Interface) -> str:
    others = [
        "+".join(other.high) if isinstance(other, Source) else other
        for other in interface.driven_with
    ]
    return f"; the source of {' and '.join(others)} is on at the same time" if others else ""
