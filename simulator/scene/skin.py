"""The skin itself: two electrode sheets around a foam, and its bounds.

All lengths in m, resistances in ohm. x runs along `length`, y along `width`; pixel (1, 1) lies at
the corner x = y = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from .foam_in_time import Humidity, Hysteresis, Relaxations, Temperature
from .foam_mechanics import Mechanics, strain_of
from .form.mesh_data import MeshData, read_along
from .form.outline import Curve, Outline, check_outline
from .form.shape import Shape, Stretch
from .frequency import Loss, penetration_depth
from .keys.key_paths import OrText
from .maps import Map
from .planar import Circle, Points, inside, reach_into, sides
from .ranges import (
    Angle,
    Length,
    LossTangent,
    PerArea,
    Permittivity,
    Piezoresistance,
    SheetResistance,
    Thickness,
)
from .validation import Number, Table, short, single_line


def curves(skin: Skin) -> list[Curve]:
    """What bounds a skin without mesh: the curve around it first, then those around its holes."""
    if skin.outline is not None:
        return [skin.outline, *skin.outline.holes]
    x, y = skin.length, skin.width
    return [Curve(points=((0.0, 0.0), (x, 0.0), (x, y), (0.0, y)))]


def on_skin(skin: Skin, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether places x of a skin without mesh, m, shape (2, ...), are on it, shape (...)."""
    around, *holes = curves(skin)
    found = around.holds(x)
    for hole in holes:
        found = found & ~hole.holds(x)
    return found


def covers(skin: Skin, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether there is skin at places x, m, shape (2, ...), as it is seen along z, shape (...)."""
    if skin.mesh is None:
        return on_skin(skin, x)
    surface = skin.mesh.surface
    found = np.zeros(x.shape[1:], dtype=bool)
    for corners in surface.p[:2, surface.t].transpose(2, 1, 0):
        low, high = corners.min(axis=0), corners.max(axis=0)
        near = np.flatnonzero(
            ((x[0] >= low[0]) & (x[0] <= high[0]) & (x[1] >= low[1]) & (x[1] <= high[1])).ravel()
        )
        found.ravel()[near] |= inside(corners, x.reshape(2, -1)[:, near])
    return found


def reaches_into(skin: Skin, low: Sequence[Points], high: Sequence[Points]) -> list[bool]:
    """Whether a part of a skin lies within each rectangle between corners (x, y); m.

    An edge of it does or the whole rectangle; on a mesh in space, as it is seen along z.
    """
    if skin.mesh is not None:
        surface = skin.mesh.surface
        triangles = surface.p[:2, surface.t].transpose(2, 1, 0)
        return [reach_into(triangles, *ends) for ends in zip(low, high, strict=True)]
    shapes = [curve.shape for curve in curves(skin)]
    circles = [shape for shape in shapes if isinstance(shape, Circle)]
    straight = [sides(shape) for shape in shapes if not isinstance(shape, Circle)]
    edges = np.concatenate([np.empty((0, 2, 2)), *straight])
    covered = on_skin(skin, (np.array(low) + high).T / 2)
    return [
        bool(within) or reach_into(edges, *ends) or any(each.passes(*ends) for each in circles)
        for *ends, within in zip(low, high, covered, strict=True)
    ]


MIN_DEPTH = 1e-6
"""That the field reaches from a foil, over the skin's longer side: cells there are as narrow.
At half of it answers still hold, after half a minute; at a tenth none comes within minutes."""

GREATEST_STRAIN = 0.99
"""Of foam without mechanics: then a hundredth of its thickness is left."""

VACUUM_PERMITTIVITY = 8.8541878128e-12
ASSUMED_PERMITTIVITY = 2.0
"""Of a foam of which nothing but c is known: open cells of rubber have 1.4 to 2.3 (a porosity of
0.67 makes 1.46 of 2.8 by Looyenga's law; the 4 mm of foam with 70 pF of the paper need 2.2)."""
ROUNDING = 1e-9
"""Relative, of a capacitance that is that of vacuum."""

Name = Annotated[str, Field(min_length=1), AfterValidator(single_line)]

Electrode = Literal["top", "bottom"]

AnyMesh = Annotated[MeshData | None, BeforeValidator(read_along), OrText("path")]


class Anisotropy(Table):
    """Conductance along a direction over that across it; the angle [rad] of the direction from x.

    The geometric mean of both is 1 / sheet_resistance.
    """

    ratio: Annotated[Number, Field(ge=1e-3, le=1e3)]
    angle: Angle = 0.0


class Sheet(Table):
    """An electrode sheet of a sheet resistance [ohm/sq], and how that varies.

    piezoresistance: its relative rise for each unit of compressive strain of the foam beneath. map:
    factor by place.
    """

    sheet_resistance: SheetResistance
    piezoresistance: Piezoresistance = 0.0
    anisotropy: Anisotropy | None = None
    map: Map | None = None


class Foam(Table):
    """The dielectric: capacitance per area [F/m²], or what it follows from, and its losses.

    loss_tangent: of jwC (1 - j tan d). phase_exponent: a of a constant-phase capacitance (jw)^a,
    which has the size that is named at 1 kHz; 1 is an ideal one. map: factor by place on the
    capacitance. mechanics: what depth or force of a press do, for a foam of known thickness; the
    permittivity then follows unless given. It also follows from a thickness beside
    capacitance_per_area, as where both are measured. relaxation: one or two standard linear solids,
    by which a pressed foam creeps and a released one recovers. hysteresis: share of the work of
    loading that unloading does not give back; a foam that is let off stays more compressed by it.
    """

    capacitance_per_area: PerArea | None = None
    thickness: Thickness | None = None
    relative_permittivity: Permittivity | None = None
    loss_tangent: LossTangent = 0.0
    phase_exponent: Annotated[Number, Field(gt=0.5, le=1)] = 1.0
    map: Map | None = None
    mechanics: Mechanics | None = None
    relaxation: Relaxations | None = None
    hysteresis: Hysteresis | None = None
    temperature: Temperature | None = None
    humidity: Humidity | None = None

    @property
    def in_time(self) -> list[str]:
        """The keys by which it depends on when it was pressed, and for how long."""
        keys = {"relaxation": self.relaxation, "hysteresis": self.hysteresis}
        return [f"skin.foam.{name}" for name, value in keys.items() if value]

    def strain_at(self, factor: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compressive strain that brings a factor on the capacitance about; 0 below 1.

        Without mechanics that of constant permittivity.
        """
        return strain_of(factor) if self.mechanics is None else self.mechanics.strain_at(factor)

    def factor_at(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """The other way round."""
        return 1 / (1 - strain) if self.mechanics is None else self.mechanics.factor(strain)

    @property
    def greatest_strain(self) -> float:
        """That foam in time may come to."""
        if self.mechanics is None:
            return GREATEST_STRAIN
        return self.mechanics.elastic.greatest_strain

    @property
    def loss(self) -> Loss:
        """Its losses as the equations take them."""
        return Loss(self.loss_tangent, self.phase_exponent)

    @property
    def thickness_or_assumed(self) -> float:
        """Its thickness in m; where that is not given, of a foam of ASSUMED_PERMITTIVITY."""
        if self.thickness is not None:
            return self.thickness
        return VACUUM_PERMITTIVITY * ASSUMED_PERMITTIVITY / self.unpressed_capacitance_per_area

    @property
    def unpressed_capacitance_per_area(self) -> float:
        """c of the foam at rest, F/m²."""
        if self.capacitance_per_area is not None:
            return self.capacitance_per_area
        permittivity = self.relative_permittivity
        if permittivity is None and self.mechanics is not None:
            permittivity = self.mechanics.unpressed_permittivity
        assert self.thickness is not None and permittivity is not None
        return VACUUM_PERMITTIVITY * permittivity / self.thickness

    @model_validator(mode="after")
    def _one_way_to_the_capacitance(self) -> Self:
        if self.mechanics is not None:
            self._one_way_of_a_foam_with(self.mechanics)
            return self
        direct, permittivity = self.capacitance_per_area, self.relative_permittivity
        if (direct is None) == (permittivity is None) or (permittivity and not self.thickness):
            raise ValueError(
                "needs either capacitance_per_area, or thickness with relative_permittivity"
            )
        return self

    @model_validator(mode="after")
    def _permittivity_of_a_dielectric(self) -> Self:
        """What follows from capacitance and thickness is at least that of vacuum."""
        if self.capacitance_per_area is not None and self.thickness is not None:
            least = VACUUM_PERMITTIVITY / self.thickness
            if self.capacitance_per_area < least * (1 - ROUNDING):
                raise ValueError(
                    f"capacitance_per_area must be >= {short(least)} F/m², that of vacuum of the "
                    f"thickness {short(self.thickness)} m, got {short(self.capacitance_per_area)}"
                )
        return self

    def _one_way_of_a_foam_with(self, mechanics: Mechanics) -> None:
        given = (self.capacitance_per_area, self.relative_permittivity)
        if self.thickness is None:
            raise ValueError("needs thickness where mechanics is given")
        if None not in given:
            raise ValueError("takes capacitance_per_area or relative_permittivity, not both")
        if given == (None, None) and mechanics.unpressed_permittivity is None:
            raise ValueError(
                "needs capacitance_per_area or relative_permittivity where "
                'mechanics.effective_medium = "constant"'
            )


class Skin(Table):
    """Two electrode sheets around a foam; length and width are those at rest, before stretching.

    It is a rectangle, or of an outline, or as a mesh file has it; the latter two have their pixels
    on the rectangle.
    """

    length: Length
    width: Length
    outline: Outline | None = None
    mesh: AnyMesh = None
    top: Sheet
    bottom: Sheet
    foam: Foam
    stretch: Stretch | None = None
    shape: Shape | None = None

    @property
    def sides(self) -> tuple[float, float]:
        """Length and width at rest, m."""
        return self.length, self.width

    @property
    def sheet_resistances(self) -> tuple[float, float]:
        """Of the top sheet and of the bottom one, ohm/sq."""
        return self.top.sheet_resistance, self.bottom.sheet_resistance

    @property
    def both_sheets(self) -> float:
        """Resistance of both sheets in series, ohm/sq."""
        return sum(self.sheet_resistances)

    def depth(self, frequency: float, factor: float = 1.0) -> float:
        """How far from a foil the field reaches at a frequency in Hz, m; see `penetration_depth`.

        factor: of the capacitance over that at rest.
        """
        c = self.foam.unpressed_capacitance_per_area * factor
        return penetration_depth(frequency, self.both_sheets, c, self.foam.loss)

    def check_depth(self, frequency: float, factor: float = 1.0) -> None:
        """Raises ValueError where the field does not reach far enough to be resolved.

        frequency: Hz. factor: of the capacitance over that at rest.
        """
        depth, least = self.depth(frequency, factor), MIN_DEPTH * max(self.sides)
        if depth < least:
            raise ValueError(
                f"`sweep.frequencies`: at {short(frequency)} Hz the field reaches {short(depth)} m "
                f"from the foils; it must reach {short(least)} m, {short(MIN_DEPTH)} of the "
                "skin's longer side, to be resolved in double precision: lower frequencies, sheet "
                "resistance or capacitance"
            )

    @property
    def rectangular(self) -> bool:
        """Whether it has neither outline nor mesh."""
        return self.outline is None and self.mesh is None

    @property
    def stretched_sides(self) -> tuple[float, float]:
        """Length and width as it is stretched, m."""
        along, across = self.stretch.ratios if self.stretch else (1.0, 1.0)
        return self.length * along, self.width * across

    @property
    def maps(self) -> dict[str, Map]:
        """Its maps, by the keys of a scene file."""
        parts = {"top": self.top, "bottom": self.bottom, "foam": self.foam}
        return {f"skin.{name}.map": part.map for name, part in parts.items() if part.map}

    @property
    def beyond_uniform(self) -> list[str]:
        """The keys by which it is more than uniform sheets and foam on a rectangle at rest.

        What `plain.form` folds in is one until then; bending to a cylinder never is one.
        """
        keys = {
            "skin.outline": self.outline is not None,
            "skin.mesh": self.mesh is not None,
            "skin.stretch": self.stretch is not None,
            "skin.shape": self.shape is not None and not self.shape.developable,
            **dict.fromkeys(self.maps, True),
        }
        for name, sheet in (("top", self.top), ("bottom", self.bottom)):
            keys[f"skin.{name}.anisotropy"] = sheet.anisotropy is not None
            keys[f"skin.{name}.piezoresistance"] = sheet.piezoresistance != 0
        return [key for key, there in keys.items() if there]

    def sheet(self, electrode: Electrode) -> Sheet:
        """The sheet that is the named electrode."""
        return self.top if electrode == "top" else self.bottom

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        if self.outline is not None and self.mesh is not None:
            raise ValueError("takes outline or mesh, got both")
        if self.outline is not None:
            check_outline(self.outline, self.length, self.width)
        return self

    @model_validator(mode="after")
    def _maps_and_shape_suit_its_sides(self) -> Self:
        for key, of_place in self.maps.items():
            try:
                of_place.check(self.sides)
            except ValueError as error:
                raise ValueError(f"`{key.removeprefix('skin.')}` {error}") from error
        if self.shape is not None:
            self.shape.check(self.stretched_sides)
        return self
