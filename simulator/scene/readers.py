"""Readers that drive a skin through series resistors and read the gain at the nodes behind them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from ..arrays import Complex, Real
from .ranges import Capacitance
from .validation import Number, Table, validated, within

if TYPE_CHECKING:
    from .contacts import Interface

ReaderName = Literal["impedance", "multisine", "gain"]
GAIN_KEYS = ("series_resistance", "source_scale", "load", "magnitude_only", "driven_with")
"""Keys of an interface that only a reader of gains has."""

SeriesResistance = Annotated[
    Number, within(1e-3, 1e12, "ohm", "a node without series resistor reads its own source")
]
SourceScale = Annotated[
    Number, within(1e-6, 1e6, "(relative)", "beyond a millionth the source has another unit")
]
LoadResistance = Annotated[
    Number, within(1e-3, 1e15, "ohm", "an input of 0 ohm shorts the node; leave it out for none")
]


class Load(Table):
    """Input of the amplifier, between a node and low: a resistance and a capacitance in parallel.

    resistance [ohm]: none by default, an input that draws no direct current. capacitance: of input
    and cable.
    """

    resistance: LoadResistance | None = None
    capacitance: Capacitance = 0.0

    def admittance(self, frequency: Real) -> Complex:
        """Admittance of the input, S. frequency: Hz."""
        conductance = 0.0 if self.resistance is None else 1 / self.resistance
        return (conductance + 2j * np.pi * frequency * self.capacitance).astype(np.complex128)


class Source(Table):
    """A source that is on while another node is read; its own node need not be an interface.

    high, low: foils as of an interface. series_resistance, source_scale, load: as of an interface.
    """

    high: Annotated[tuple[str, ...], Field(min_length=1)]
    low: tuple[str, ...] = ()
    series_resistance: SeriesResistance
    source_scale: SourceScale = 1.0
    load: Load = Load()


def checked_sources(given: object) -> object:
    """Converts tables in a list of names and tables to sources; a name alone to a list."""
    if not isinstance(given, list | tuple):
        return [given] if isinstance(given, str) else given
    return [validated(Source, one) if isinstance(one, Mapping) else one for one in given]


def check_reader(interface: Interface) -> None:
    """Raises ValueError if an interface lacks keys of its reader or has those of another one."""
    if interface.reader == "gain":
        if interface.series_resistance is None:
            raise ValueError(
                'with reader = "gain" needs series_resistance, in ohm: the resistor between the '
                "source and the node"
            )
        return
    for key in GAIN_KEYS:
        if not is_default(interface, key):
            raise ValueError(f'takes {key} with reader = "gain" only')


def is_default(interface: Interface, key: str) -> bool:
    """True if a key of an interface has its default."""
    return getattr(interface, key) == type(interface).model_fields[key].default


def sources(interface: Interface, interfaces: Sequence[Interface]) -> list[Source]:
    """Sources that are on while an interface is read, its own first.

    Raises ValueError for a name that is none of the other interfaces.
    """
    found = [own_source(interface)]
    by_name = {each.name: each for each in interfaces if each.name != interface.name}
    for other in interface.driven_with:
        if isinstance(other, Source):
            found.append(other)
        elif other in by_name:
            found.append(own_source(by_name[other]))
        else:
            allowed = f"one of {', '.join(by_name)}" if by_name else "left out: there is no other"
            raise ValueError(
                f"interface {interface.name!r}: `driven_with` must be {allowed}, got {other!r}"
            )
    return found


def own_source(interface: Interface) -> Source:
    """The source of an interface that reads gains."""
    assert interface.series_resistance is not None
    return Source(
        high=interface.high,
        low=interface.low,
        series_resistance=interface.series_resistance,
        source_scale=interface.source_scale,
        load=interface.load or Load(),
    )


def check_readers(interfaces: Sequence[Interface], terminal: Mapping[str, int]) -> None:
    """Raises ValueError unless all readers are equal in kind and their sources fit together.

    terminal: number of the terminal of each foil.
    """
    first = interfaces[0]
    for each in interfaces:
        for key in ("reader", "magnitude_only"):
            one, other = getattr(first, key), getattr(each, key)
            if one != other:
                raise ValueError(
                    f"all interfaces must have the same `{key}`, got {_toml(one)} of "
                    f"{first.name!r} and {_toml(other)} of {each.name!r}"
                )
    for each in interfaces:
        if each.driven_with:
            _check_sources(each.name, sources(each, interfaces), terminal)


def _check_sources(name: str, on: Sequence[Source], terminal: Mapping[str, int]) -> None:
    foils = {foil for source in on for foil in (*source.high, *source.low)}
    for foil in sorted(foils - set(terminal)):
        raise ValueError(
            f"interface {name!r}: `driven_with` names the contact {foil!r}; there are "
            f"{', '.join(terminal)}"
        )
    nodes = [{terminal[foil] for foil in source.high} for source in on]
    low = {terminal[foil] for source in on for foil in source.low}
    if any(node & low for node in nodes):
        raise ValueError(f"interface {name!r}: a node of `driven_with` is low at another one")
    if any(one & other for one, other in itertools.combinations(nodes, 2)):
        raise ValueError(f"interface {name!r}: two nodes of `driven_with` are one terminal")


def _toml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


def with_sources(
    interfaces: Sequence[Interface], among: Sequence[Interface]
) -> tuple[Interface, ...]:
    """Some interfaces of a scene; the names of others in `driven_with` become their sources."""
    kept = {each.name for each in interfaces}
    found = []
    for each in interfaces:
        on = tuple(
            source if isinstance(other, str) and other not in kept else other
            for other, source in zip(each.driven_with, sources_of_others(each, among), strict=True)
        )
        found.append(each.model_copy(update={"driven_with": on}))
    return tuple(found)


def sources_of_others(interface: Interface, among: Sequence[Interface]) -> list[Source]:
    """Sources that are on together with an interface's own one."""
    return sources(interface, among)[1:] if interface.driven_with else []
