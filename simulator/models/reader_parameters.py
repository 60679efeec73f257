"""Parameters of readers of gains: sources, resistors and inputs, of all interfaces together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..scene.readings.readers import Load, Source, own_source

if TYPE_CHECKING:
    from ..scene.parts import Setup
    from ..scene.readings.contacts import Interface

SOURCE = "source_scale"
READER = (SOURCE, "series_resistance", "load_capacitance", "load_conductance")
"""Scale of the source, and on request ohm, F and S, of the first interface. Scales and resistors of
all others change by the same factor, and their inputs by the same capacitance and conductance."""


def reader_values(setup: Setup) -> dict[str, float]:
    """Parameters of the scene's readers; none where they read impedances."""
    if not setup.gain:
        return {}
    first = own_source(setup.interfaces[0])
    load = first.load.capacitance, _conductance(first.load)
    return dict(zip(READER, (first.source_scale, first.series_resistance, *load), strict=True))


def smallest_load_capacitance(setup: Setup) -> float:
    """Capacitance of the first input at which the smallest one of all inputs is 0, F."""
    every = [own_source(each).load.capacitance for each in setup.interfaces]
    return every[0] - min(every)


def with_reader(
    interfaces: Sequence[Interface], values: Mapping[str, float]
) -> tuple[Interface, ...]:
    """Interfaces whose readers have these parameters; others keep theirs."""
    own = own_source(interfaces[0])
    scale = values.get(SOURCE, own.source_scale) / own.source_scale
    factor = values.get("series_resistance", own.series_resistance) / own.series_resistance
    capacitance = values.get("load_capacitance", own.load.capacitance) - own.load.capacitance
    conductance = values.get("load_conductance", _conductance(own.load)) - _conductance(own.load)
    if (scale, factor, capacitance, conductance) == (1.0, 1.0, 0.0, 0.0):
        return tuple(interfaces)

    def changed(part: Interface | Source) -> dict[str, object]:
        load, assumed = part.load or Load(), part.series_resistance
        assert assumed is not None
        total = _conductance(load) + conductance
        update = {
            "capacitance": load.capacitance + capacitance,
            "resistance": 1 / total if total > 0 else None,
        }
        return {
            "source_scale": part.source_scale * scale,
            "series_resistance": assumed * factor,
            "load": load.model_copy(update=update),
        }

    found = []
    for each in interfaces:
        others = tuple(
            other.model_copy(update=changed(other)) if isinstance(other, Source) else other
            for other in each.driven_with
        )
        found.append(each.model_copy(update={**changed(each), "driven_with": others}))
    return tuple(found)


def _conductance(load: Load) -> float:
    return 0.0 if load.resistance is None else 1 / load.resistance
