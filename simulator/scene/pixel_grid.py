"""The grid of pixels, and the press of a pixel.

A touch that adds C to earth on an area A of a skin with c to earth multiplies c there by 1 + C /
(c A).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from .randomisation import AnyDistribution, Fixed, Normal, Uniform
from .ranges import MAX_FACTOR, AnyFinger, CapacitanceFactor, Force, Thickness, TouchCapacitance
from .skin import Name
from .validation import Number, Table, Whole, short

if TYPE_CHECKING:
    from .parts import Skin
    from .randomisation import DrawnPress
    from .skin import SheetsAndFoam

Added = Literal["capacitance to earth"]
NEEDS_ONE_CONDUCTOR = (
    '`press.adds` needs `skin.bottom = "earth"`, a skin of one conductor; on two sheets a touch to '
    "earth is `press.finger` with [surroundings]"
)
UNSUITED = {
    "skin.outline": lambda skin: skin.outline is not None,
    "skin.mesh": lambda skin: skin.mesh is not None,
    "skin.stretch": lambda skin: skin.stretch is not None,
    "skin.foam.map": lambda skin: skin.foam.map is not None,
}
"""Keys with which equal touches of pixels are no equal factors."""


def per_pixel(skin: SheetsAndFoam, pixels: Pixels) -> float:
    """Capacitance of an unpressed pixel of a rectangular skin, F."""
    area = skin.length * skin.width / (pixels.rows * pixels.columns)
    return skin.foam.unpressed_capacitance_per_area * area


def with_factor(press: Pressing, skin: SheetsAndFoam, pixels: Pixels) -> Pressing:
    """The press with the factor of its capacitance.

    Raises ValueError naming the key that suits no such touch.
    """
    assert press.capacitance is not None
    if not skin.one_conductor:
        raise ValueError(NEEDS_ONE_CONDUCTOR)
    for key, given in UNSUITED.items():
        if given(skin):
            raise ValueError(f"`press.adds` needs a uniform rectangle, without `{key}`")
    own = per_pixel(skin, pixels)
    factor = 1 + press.capacitance / own
    if factor > MAX_FACTOR:
        raise ValueError(
            f"`press.capacitance` must be <= {short((MAX_FACTOR - 1) * own)} F, {MAX_FACTOR:g} "
            f"times the capacitance of an untouched pixel, got {short(press.capacitance)}"
        )
    return press.model_copy(update={"capacitance_factor": factor})


def with_drawn_factor(
    drawn: DrawnPress, press: Pressing, skin: SheetsAndFoam, pixels: Pixels
) -> DrawnPress:
    """Drawn presses with the factor of their capacitance, by default that of the scene's press.

    Raises ValueError for places and distributions that suit no such touch.
    """
    if drawn.place == "anywhere":
        raise ValueError('`dataset.press.place` must be "pixel" with `press.adds`')
    if drawn.offset and drawn.max_touches > 1:
        raise ValueError(
            "`dataset.press.offset` with `press.adds` needs `dataset.press.touches` of one touch "
            "at most: two displaced touches could overlap"
        )
    assert press.capacitance is not None
    capacitance = drawn.capacitance or Fixed(value=press.capacitance)
    own = per_pixel(skin, pixels)
    factor = _along(capacitance, lambda farad: 1 + farad / own)
    if not 1 <= factor.low <= factor.high <= MAX_FACTOR:
        raise ValueError(
            f"`dataset.press.capacitance` must be from 0 to {short((MAX_FACTOR - 1) * own)} F, got "
            f"{short(capacitance.low)} to {short(capacitance.high)}"
        )
    return drawn.model_copy(update={"capacitance": capacitance, "factor": factor})


def _along(drawn: AnyDistribution, line: Callable[[float], float]) -> AnyDistribution:
    """Distribution of a linear function of a drawn quantity."""
    match drawn:
        case Fixed():
            return Fixed(value=line(drawn.value))
        case Uniform():
            return Uniform(low=line(drawn.low), high=line(drawn.high))
        case Normal():
            deviation = line(drawn.deviation) - line(0.0)
            return Normal(mean=line(drawn.mean), deviation=deviation, cut=drawn.cut)
    raise ValueError("`dataset.press.capacitance` must be fixed, uniform or normal")


PRESSED_BY = ("capacitance_factor", "depth", "force", "capacitance")


class Pixels(Table):
    """The grid of pixels, by which presses are named.

    rows: number along y, row 1 along the bottom edge. columns: number along x, column 1 along the
    left edge. groups: on a mesh, names of the groups of elements that form the pixels, by row and
    column.
    """

    rows: Annotated[Whole, Field(ge=1, le=1000)]
    columns: Annotated[Whole, Field(ge=1, le=1000)]
    groups: tuple[tuple[Name, ...], ...] | None = None

    @model_validator(mode="after")
    def _groups_fill_the_grid(self) -> Self:
        if self.groups is not None and [len(row) for row in self.groups] != (
            [self.columns] * self.rows
        ):
            raise ValueError(
                f"groups must be {self.rows} rows of {self.columns} names, as many as pixels"
            )
        return self

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.rows, self.columns


class Pressing(Table):
    """The press of a pixel: its capacitance over the unpressed one, and the spread of presses.

    capacitance_factor: capacitance of a pressed pixel over the unpressed one. factor_spread:
    standard deviation of the rise (factor - 1), as a fraction of that rise. depth: into the foam,
    by a rigid flat applicator of the pixel's shape, in place of the factor. force: on such an
    applicator, in place of the factor. finger: the finger of an earthed person, or of a floating
    one (150 pF to earth), or a capacitance to earth [F]; default a rod without capacitance to
    earth. A finger needs [surroundings]. adds: a touch does not press; it adds `capacitance` to
    that of a skin of one conductor (`skin.bottom = "earth"`), with the spread factor_spread.
    capacitance: to earth, which a touch adds.
    """

    capacitance_factor: CapacitanceFactor = 2.0
    factor_spread: Annotated[Number, Field(ge=0, lt=1)] = 0.0
    depth: Thickness | None = None
    force: Force | None = None
    finger: AnyFinger | None = None
    adds: Added | None = None
    capacitance: TouchCapacitance | None = None

    @property
    def by_factor(self) -> bool:
        """True if pixels are pressed by a capacitance factor."""
        return self.depth is None and self.force is None

    def factor(self, skin: Skin) -> float:
        """Capacitance factor of a pressed pixel of a skin.

        Raises InputError for a depth beyond the foam's range, and for a force, which presses pixels
        to different depths.
        """
        return self.capacitance_factor if self.by_factor else skin.factor_at(self.depth)

    def as_factor(self, skin: Skin) -> Pressing:
        """The press by the factor that its depth causes; itself if it is by a factor.

        Raises InputError as `factor` does.
        """
        if self.by_factor:
            return self
        return Pressing(
            capacitance_factor=self.factor(skin),
            factor_spread=self.factor_spread,
            finger=self.finger,
        )

    @model_validator(mode="after")
    def _pressed_one_way(self) -> Self:
        named = [name for name in PRESSED_BY if name in self.model_fields_set]
        given = [name for name in named if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"takes one of {', '.join(PRESSED_BY)}, got {' and '.join(given)}")
        if (self.adds is None) != (self.capacitance is None):
            raise ValueError('takes adds = "capacitance to earth" and capacitance in F together')
        if self.adds and self.finger is not None:
            raise ValueError("takes adds or finger, got both")
        return self

    @model_serializer(mode="wrap")
    def _what_was_given(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        unused = () if self.by_factor and not self.adds else (PRESSED_BY[0],)
        if not self.adds:
            unused = (*unused, "adds", "capacitance")
        return {k: v for k, v in kept.items() if k not in unused}
