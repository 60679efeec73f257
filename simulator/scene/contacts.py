"""Foils on the edges of the sheets, and the interfaces that connect them to a meter."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Annotated, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    Strict,
    model_serializer,
    model_validator,
)

from ..arrays import Mask, Real
from .form import Outline
from .keys import OrText
from .meter import ascending
from .ranges import FilmResistance, Frequency, Overlap
from .readers import (
    GAIN_KEYS,
    Load,
    ReaderName,
    SeriesResistance,
    Source,
    SourceScale,
    check_reader,
    checked_sources,
    is_default,
)
from .skin import Electrode, Name, SheetsAndFoam
from .skin_region import curves, on_skin
from .validation import Number, Table, whole_within_rounding

MAX_CONTACTS = 200
"""Limit: all pairs are compared, and a mesh has rings around the ends of each contact."""
MAX_INTERFACES = 1000
"""Limit: each interface is read at every frequency; a scanner has tens of channels."""
EDGES = ("left", "right", "bottom", "top")
LINES = 33
"""Number of sample points along each side of the skin."""
EDGE = re.compile(r"(?P<curve>outline|hole(?P<hole>[1-9]\d*))(?:\.(?P<side>[1-9]\d*))?")


class CurveSection(NamedTuple):
    """A part of a closed curve: number of the curve, start and stop along it in m."""

    curve: int
    start: float
    stop: float


def curve_section(contact: Contact, skin: SheetsAndFoam) -> CurveSection:
    """The part of a boundary curve that a foil covers, for a skin without mesh."""
    low, high = contact.span
    if skin.outline is None:
        return _along_rectangle(contact.edge, low, high, skin)
    curve, side = _parsed(contact.edge)
    marks = curves(skin)[curve].marks
    start, stop = (marks[0], marks[-1]) if side is None else (marks[side - 1], marks[side])
    return CurveSection(curve, start + low * (stop - start), start + high * (stop - start))


def path(contact: Contact, skin: SheetsAndFoam, pieces: int = 64) -> Real:
    """Points along a foil on a skin without mesh, in m, shape (2, pieces + 1)."""
    along = curve_section(contact, skin)
    curve = curves(skin)[along.curve]
    return np.array([curve.at(mark) for mark in np.linspace(*along[1:], pieces + 1)]).T


def outwards(path: Real, skin: SheetsAndFoam) -> Real:
    """Outward unit vectors along a path on the skin's edge, both of shape (2, point)."""
    x, y = np.gradient(path, axis=1)
    across = np.stack([y, -x]) / np.hypot(x, y)
    step = 1e-4 * max(skin.sides)
    middle = np.s_[:, path.shape[1] // 2]
    return -across if on_skin(skin, (path + step * across)[middle]) else across


def max_foil_distance(
    skin: SheetsAndFoam, contacts: Sequence[Contact], interfaces: Sequence[Interface | Source]
) -> float:
    """The largest distance of a point of the skin from its nearest driven foil, m.

    For a mesh from a file, the longer side of the grid of pixels.
    """
    if skin.mesh is not None:
        return max(skin.sides)
    driven = {name for each in interfaces for name in (*each.high, *each.low)}
    foils = np.hstack([path(contact, skin) for contact in contacts if contact.name in driven])
    places = _places(skin)
    square = ((places[:, :, None] - foils[:, None]) ** 2).sum(axis=0)
    return float(np.sqrt(square.min(axis=1).max()))


def _places(skin: SheetsAndFoam) -> Real:
    """Sample points of a skin, including its outline, m, shape (2, point)."""
    x, y = np.meshgrid(*(np.linspace(0, side, LINES) for side in skin.sides))
    everywhere = np.stack([x.ravel(), y.ravel()])
    if skin.outline is None:
        return everywhere
    marks = np.linspace(0, skin.outline.marks[-1], 4 * LINES)
    around = np.array([skin.outline.at(mark) for mark in marks]).T
    return np.hstack([everywhere[:, on_skin(skin, everywhere)], around])


def _along_rectangle(edge: str, low: float, high: float, skin: SheetsAndFoam) -> CurveSection:
    """Section along a rectangle, anticlockwise from (0, 0); spans start at the low-coordinate
    end."""
    x, y = skin.length, skin.width
    start, run = {
        "bottom": (0.0, x),
        "right": (x, y),
        "top": (2 * x + y, -x),
        "left": (2 * (x + y), -y),
    }[edge]
    first, last = sorted((start + low * run, start + high * run))
    return CurveSection(0, first, last)


def _parsed(edge: str) -> tuple[int, int | None]:
    match = EDGE.fullmatch(edge)
    assert match is not None
    return int(match["hole"] or 0), int(match["side"]) if match["side"] else None


def check_edge(edge: str, skin: SheetsAndFoam) -> str | None:
    """Message with the allowed edges of a skin without mesh; None if the edge is allowed."""
    if skin.outline is None:
        return None if edge in EDGES else "must be 'left', 'right', 'bottom' or 'top'"
    allowed = _edges(skin.outline)
    match = EDGE.fullmatch(edge)
    if match is not None:
        sides_there = allowed.get(match["curve"])
        if sides_there is not None and int(match["side"] or 0) <= sides_there:
            return None
    return "must be " + " or ".join(
        f"'{name}', '{name}.1'..'{name}.{count}'" if count else f"'{name}'"
        for name, count in allowed.items()
    )


def _edges(outline: Outline) -> dict[str, int]:
    """Boundary curves by name, with the number of sides that foils can refer to."""
    named = {"outline": outline, **{f"hole{i + 1}": hole for i, hole in enumerate(outline.holes)}}
    return {name: len(curve.points or ()) for name, curve in named.items()}


Fraction = Annotated[Number, Field(ge=0, le=1), AfterValidator(whole_within_rounding)]


class Contact(Table):
    """A foil strip on one electrode: an equipotential terminal along part of an edge.

    name: by which interfaces refer to the contact. electrode: the sheet that it touches. span: its
    two ends as fractions of the edge. resistance: of the film between foil and sheet. edge: left,
    right, bottom or top on a rectangle; "outline", "outline.3" (its third side), "hole1" or
    "hole1.2" on an outline; the name of a group of boundary lines on a mesh. width [m]: how far it
    overlaps the sheet, which has its potential there; 0 is a foil on the edge alone.
    """

    name: Name
    electrode: Electrode
    edge: Name
    span: tuple[Fraction, Fraction] = (0.0, 1.0)
    resistance: FilmResistance = 0.0
    width: Overlap = 0.0

    @property
    def ideal(self) -> bool:
        """True if the contact has no resistance, so that its part of the edge has one potential."""
        return self.resistance == 0

    def ends(self, skin: SheetsAndFoam) -> tuple[tuple[float, float], tuple[float, float]]:
        """Both end points (x, y) in m, the low-coordinate end first; on outlines in their order.

        Foils on meshes are defined by their facets instead.
        """
        if skin.outline is not None:
            along = curve_section(self, skin)
            curve = curves(skin)[along.curve]
            return curve.at(along.start), curve.at(along.stop)
        low, high = self.span
        if self.edge in ("left", "right"):
            x = 0.0 if self.edge == "left" else skin.length
            return (x, low * skin.width), (x, high * skin.width)
        y = 0.0 if self.edge == "bottom" else skin.width
        return (low * skin.length, y), (high * skin.length, y)

    @model_validator(mode="after")
    def _span_has_length(self) -> Self:
        if not self.span[0] < self.span[1]:
            raise ValueError(f"span must run from a lower to a higher fraction, got {self.span}")
        return self

    @model_validator(mode="after")
    def _wide_or_resistive(self) -> Self:
        if self.width and self.resistance:
            raise ValueError(
                "takes width or resistance, got both: a foil with a width is ideal on all of it"
            )
        return self

    @model_serializer(mode="wrap")
    def _width_where_there_is_one(
        self, everything: SerializerFunctionWrapHandler
    ) -> dict[str, object]:
        kept = everything(self)
        return kept if self.width else {k: v for k, v in kept.items() if k != "width"}


class Interface(Table):
    """One way of connecting the meter or another reader; contacts in neither list float.

    Earth, in scenes with surroundings, is at low. name: by which commands and results refer to the
    interface. high: names of the contacts at the high terminal. low: names of those at the low
    terminal; "earth" for a skin of one conductor (`skin.bottom = "earth"`). frequencies: the
    frequencies of [sweep] at which it is read [Hz]; default: all of them. reader: "impedance", that
    between high and low, as a meter reads it; "multisine", the same at all frequencies at once, by
    the electronics of readout.multisine; "gain", the complex gain V / V_s of the node that high is,
    with a source V_s behind a series resistor between it and low. The reader is the same at all
    interfaces. series_resistance: for gains, that of the resistor behind the source. source_scale:
    for gains, the voltage of the source over the one that readings are divided by; `calibrate`
    fits it. load: for gains, the input of the amplifier that reads the node. magnitude_only: for
    gains, true if |V / V_s| is read and no phase; the same at all interfaces. driven_with: for
    gains, names of the other interfaces whose sources are on at the same time, or tables of sources
    whose nodes are not read; all low foils of sources that are on are tied together.
    """

    name: Name
    high: Annotated[tuple[str, ...], Field(min_length=1)]
    low: Annotated[tuple[str, ...], Field(min_length=1), OrText('`"earth"`')]
    frequencies: (
        Annotated[tuple[Frequency, ...], Field(min_length=1), AfterValidator(ascending)] | None
    ) = None
    reader: ReaderName = "impedance"
    series_resistance: SeriesResistance | None = None
    source_scale: SourceScale = 1.0
    load: Load | None = None
    magnitude_only: Annotated[bool, Strict()] = False
    driven_with: Annotated[tuple[Name | Source, ...], BeforeValidator(checked_sources)] = ()

    @model_validator(mode="after")
    def _reader_has_its_keys(self) -> Self:
        check_reader(self)
        return self

    @model_serializer(mode="wrap")
    def _keys_of_its_reader(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        unset = {key for key in ("reader", *GAIN_KEYS) if is_default(self, key)}
        return {key: value for key, value in everything(self).items() if key not in unset}


def taken(interfaces: Sequence[Interface], frequency: Real) -> Mask | None:
    """Mask of the readings taken, shape (interface, frequency); None if all are taken.

    frequency: Hz.
    """
    if all(each.frequencies is None for each in interfaces):
        return None
    own_frequencies = [
        frequency if each.frequencies is None else each.frequencies for each in interfaces
    ]
    found = np.stack([np.isin(frequency, own) for own in own_frequencies])
    return None if found.all() else found


def check_frequencies(interfaces: Sequence[Interface], frequency: Sequence[float]) -> None:
    """Raises ValueError unless interfaces use only these frequencies, and every one of them."""
    for each in interfaces:
        foreign = sorted(set(each.frequencies or ()) - set(frequency))
        if foreign:
            raise ValueError(
                f"interface {each.name!r}: `frequencies` must be among those of [sweep], "
                f"got {foreign[0]:.12g} Hz"
            )
    read = taken(interfaces, np.array(frequency))
    idle = [] if read is None else np.array(frequency)[~read.any(axis=0)].tolist()
    if idle:
        raise ValueError(f"`sweep.frequencies`: no interface is read at {idle[0]:.12g} Hz")
