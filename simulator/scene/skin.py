"""The skin: two electrode sheets around a foam, and its boundary.

Lengths are in m, resistances in ohm. x runs along `length`, y along `width`; pixel (1, 1) lies at
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
from .form.mesh_extent import check_extent
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
    """Boundary of a skin without mesh: the outer curve first, then the curves of its holes."""
    if skin.outline is not None:
        return [skin.outline, *skin.outline.holes]
    x, y = skin.length, skin.width
    return [Curve(points=((0.0, 0.0), (x, 0.0), (x, y), (0.0, y)))]


def on_skin(skin: Skin, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """True where positions x in m, shape (2, ...), are on a skin without mesh, shape (...)."""
    around, *holes = curves(skin)
    found = around.holds(x)
    for hole in holes:
        found = found & ~hole.holds(x)
    return found


def covers(skin: Skin, x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """True where positions x in m, shape (2, ...), are on the skin seen along z, shape (...)."""
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
    """True for each rectangle between corners (x, y), in m, that contains a part of a skin.

    An edge of the skin runs through such a rectangle, or the whole rectangle lies on the skin. A
    mesh in space counts by its view along z.
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
"""Smallest penetration depth of the field from a foil, over the skin's longer side.

Mesh cells near the foil are as narrow. At half of it results are still accurate, after half a
minute; at a tenth of it there is none within minutes."""

GREATEST_STRAIN = 0.99
"""Largest strain of a foam without mechanics: a hundredth of its thickness is left."""

VACUUM_PERMITTIVITY = 8.8541878128e-12
ASSUMED_PERMITTIVITY = 2.0
"""Relative permittivity of a foam of which only c is known.

Open-cell rubber has 1.4 to 2.3: by Looyenga's law a porosity of 0.67 gives 1.46 for a solid of 2.8;
4 mm of the paper's foam with 70 pF need 2.2."""
ROUNDING = 1e-9
"""Relative rounding error allowed in a capacitance that equals that of vacuum."""

Name = Annotated[str, Field(min_length=1), AfterValidator(single_line)]

Electrode = Literal["top", "bottom"]

AnyMesh = Annotated[MeshData | None, BeforeValidator(read_along), OrText("path")]


class Anisotropy(Table):
    """Anisotropic conductance of a sheet.

    ratio: conductance along a direction over that across it; their geometric mean is
    1 / sheet_resistance. angle [rad]: of that direction from x.
    """

    ratio: Annotated[Number, Field(ge=1e-3, le=1e3)]
    angle: Angle = 0.0


class Sheet(Table):
    """An electrode sheet: its sheet resistance [ohm/sq] and the variation of it.

    piezoresistance: relative rise of the sheet resistance per unit of compressive strain of the
    foam beneath. map: factor by position.
    """

    sheet_resistance: SheetResistance
    piezoresistance: Piezoresistance = 0.0
    anisotropy: Anisotropy | None = None
    map: Map | None = None


class Foam(Table):
    """The dielectric: its capacitance per area [F/m²], given or computed, and its losses.

    The capacitance is computed from thickness and relative_permittivity. If thickness and
    capacitance_per_area are both given, such as from measurements, they determine the permittivity.
    loss_tangent: tan d in jwC (1 - j tan d). phase_exponent: a of a constant-phase capacitance
    (jw)^a, which has its nominal value at 1 kHz; 1 is an ideal capacitor. map: factor on the
    capacitance by position. mechanics: response to depth or force of a press; it needs the
    thickness, and gives the permittivity unless that or capacitance_per_area is given. relaxation:
    one or two standard linear solids, by which the foam creeps under a press and recovers after it.
    hysteresis: fraction of the work of loading that unloading does not return; at the same load, a
    foam is more compressed in unloading than in loading.
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
        """Keys that make the foam depend on time and duration of earlier presses."""
        keys = {"relaxation": self.relaxation, "hysteresis": self.hysteresis}
        return [f"skin.foam.{name}" for name, value in keys.items() if value]

    def strain_at(self, factor: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compressive strain at a capacitance factor; 0 for factors below 1.

        The permittivity is constant without mechanics.
        """
        return strain_of(factor) if self.mechanics is None else self.mechanics.strain_at(factor)

    def factor_at(self, strain: NDArray[np.float64]) -> NDArray[np.float64]:
        """Capacitance factor at a compressive strain, the inverse of `strain_at`."""
        return 1 / (1 - strain) if self.mechanics is None else self.mechanics.factor(strain)

    @property
    def greatest_strain(self) -> float:
        """Largest compressive strain that is accepted for creep and hysteresis."""
        if self.mechanics is None:
            return GREATEST_STRAIN
        return self.mechanics.elastic.greatest_strain

    @property
    def loss(self) -> Loss:
        """Losses of the foam for the model's equations."""
        return Loss(self.loss_tangent, self.phase_exponent)

    @property
    def thickness_or_assumed(self) -> float:
        """Thickness in m; if it is not given, that of a foam of ASSUMED_PERMITTIVITY."""
        if self.thickness is not None:
            return self.thickness
        return VACUUM_PERMITTIVITY * ASSUMED_PERMITTIVITY / self.unpressed_capacitance_per_area

    @property
    def unpressed_capacitance_per_area(self) -> float:
        """Capacitance per area of the unpressed foam, F/m²."""
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
        """Raises ValueError if capacitance and thickness give less permittivity than vacuum has."""
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
    """Two electrode sheets around a foam; length and width are those before stretching.

    The skin is a rectangle, or has an outline, or comes from a mesh file. With an outline or
    a mesh, the grid of pixels lies on the rectangle of length and width.
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
        """Length and width of the unstretched skin, m."""
        return self.length, self.width

    @property
    def sheet_resistances(self) -> tuple[float, float]:
        """Sheet resistances of the top and the bottom sheet, ohm/sq."""
        return self.top.sheet_resistance, self.bottom.sheet_resistance

    @property
    def both_sheets(self) -> float:
        """Resistance of both sheets in series, ohm/sq."""
        return sum(self.sheet_resistances)

    def depth(self, frequency: float, factor: float = 1.0) -> float:
        """Penetration depth of the field from a foil at a frequency in Hz, m.

        factor: capacitance over the unpressed one. See `penetration_depth`.
        """
        c = self.foam.unpressed_capacitance_per_area * factor
        return penetration_depth(frequency, self.both_sheets, c, self.foam.loss)

    def check_depth(self, frequency: float, factor: float = 1.0) -> None:
        """Raises ValueError if the penetration depth is too small to be resolved.

        frequency: Hz. factor: capacitance over the unpressed one.
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
        """True if the skin has neither outline nor mesh."""
        return self.outline is None and self.mesh is None

    @property
    def stretched_sides(self) -> tuple[float, float]:
        """Length and width of the stretched skin, m."""
        along, across = self.stretch.ratios if self.stretch else (1.0, 1.0)
        return self.length * along, self.width * across

    @property
    def maps(self) -> dict[str, Map]:
        """Maps of the sheets and of the foam by their keys in a scene file."""
        parts = {"top": self.top, "bottom": self.bottom, "foam": self.foam}
        return {f"skin.{name}.map": part.map for name, part in parts.items() if part.map}

    @property
    def beyond_uniform(self) -> list[str]:
        """Keys that make the skin more than uniform sheets and foam on an unstretched rectangle.

        Parts that `models.uniform.equivalent_skin` can represent by a uniform skin are included;
        bending to a cylinder is not.
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
        """The sheet of an electrode."""
        return self.top if electrode == "top" else self.bottom

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        if self.outline is not None and self.mesh is not None:
            raise ValueError("takes outline or mesh, got both")
        if self.outline is not None:
            check_outline(self.outline, self.length, self.width)
        if self.mesh is not None:
            check_extent(self.mesh.surface, self.length, self.width)
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
