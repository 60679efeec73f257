"""What is there: a skin, its contacts, the ways a meter is connected, and what is measured.

All lengths in m, resistances in ohm, frequencies in Hz. x runs along `length`, y along `width`;
pixel (1, 1) lies at the corner x = y = 0.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from simulator.contour import Outline, check_outline, curves, section
from simulator.foam_properties import Mechanics
from simulator.frequency import Loss
from simulator.leads import Leads
from simulator.maps import Map
from simulator.measuring import Experiment, Readout, Sweep
from simulator.mesh_file import absolute
from simulator.randomisation import Randomisation
from simulator.shape import Shape, Stretch
from simulator.table import Table
from simulator.validation import (
    Number,
    Whole,
    above_zero,
    at_least_zero,
    single_line,
    whole_within_rounding,
)
from simulator.wiring import DrivenByTouch, check_wiring, driven_by_touch

VACUUM_PERMITTIVITY = 8.8541878128e-12
PRESSED_BY = ("capacitance_factor", "depth", "force")

Metre = Annotated[Number, above_zero("m")]
Fraction = Annotated[Number, Field(ge=0, le=1), AfterValidator(whole_within_rounding)]
Name = Annotated[str, Field(min_length=1), AfterValidator(single_line)]
Electrode = Literal["top", "bottom"]
MeshPath = Annotated[Name, AfterValidator(absolute)]


class Anisotropy(Table):
    """Conductance along a direction over that across it; the angle [rad] of the direction from x.

    The geometric mean of both is 1 / sheet_resistance.
    """

    ratio: Annotated[Number, Field(ge=1e-3, le=1e3)]
    angle: Annotated[Number, Field(allow_inf_nan=False)] = 0.0


class Sheet(Table):
    """An electrode sheet of a sheet resistance [ohm/sq], and how that varies.

    piezoresistance: its relative rise for each unit of compressive strain of the foam beneath. map:
    factor by place.
    """

    sheet_resistance: Annotated[Number, above_zero("ohm/sq")]
    piezoresistance: Annotated[Number, Field(gt=-1, allow_inf_nan=False)] = 0.0
    anisotropy: Anisotropy | None = None
    map: Map | None = None


class Foam(Table):
    """The dielectric: capacitance per area [F/m²], or what it follows from, and its losses.

    loss_tangent: of jwC (1 - j tan d). phase_exponent: a of a constant-phase capacitance (jw)^a,
    which has the size that is named at 1 kHz; 1 is an ideal one. map: factor by place on the
    capacitance. mechanics: what depth or force of a press do, for a foam of known thickness; the
    permittivity then follows unless given.
    """

    capacitance_per_area: Annotated[Number, above_zero("F/m²")] | None = None
    thickness: Metre | None = None
    relative_permittivity: Annotated[Number, Field(ge=1, allow_inf_nan=False)] | None = None
    loss_tangent: Annotated[Number, at_least_zero("(tan d)")] = 0.0
    phase_exponent: Annotated[Number, Field(gt=0.5, le=1)] = 1.0
    map: Map | None = None
    mechanics: Mechanics | None = None

    @property
    def loss(self) -> Loss:
        """Its losses as the equations take them."""
        return Loss(self.loss_tangent, self.phase_exponent)

    @property
    def rest_capacitance_per_area(self) -> float:
        """c of the foam at rest, F/m²."""
        if self.capacitance_per_area is not None:
            return self.capacitance_per_area
        permittivity = self.relative_permittivity
        if permittivity is None and self.mechanics is not None:
            permittivity = self.mechanics.rest_permittivity
        assert self.thickness is not None and permittivity is not None
        return VACUUM_PERMITTIVITY * permittivity / self.thickness

    @model_validator(mode="after")
    def _one_way_to_the_capacitance(self) -> Self:
        if self.mechanics is not None:
            self._one_way_of_a_foam_with(self.mechanics)
            return self
        geometry = (self.thickness, self.relative_permittivity)
        direct = self.capacitance_per_area is not None
        if geometry.count(None) == 1 or direct == (None not in geometry):
            raise ValueError(
                "needs either capacitance_per_area, or thickness with relative_permittivity"
            )
        return self

    def _one_way_of_a_foam_with(self, mechanics: Mechanics) -> None:
        given = (self.capacitance_per_area, self.relative_permittivity)
        if self.thickness is None:
            raise ValueError("needs thickness where mechanics is given")
        if None not in given:
            raise ValueError("takes capacitance_per_area or relative_permittivity, not both")
        if given == (None, None) and mechanics.rest_permittivity is None:
            raise ValueError(
                "needs capacitance_per_area or relative_permittivity where "
                'mechanics.effective_medium = "constant"'
            )


class Skin(Table):
    """Two electrode sheets around a foam; length and width are those at rest, before stretching.

    It is a rectangle, or of an outline, or as a mesh file has it; the latter two have their pixels
    on the rectangle.
    """

    length: Metre
    width: Metre
    outline: Outline | None = None
    mesh: MeshPath | None = None
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
    def stretched_sides(self) -> tuple[float, float]:
        """Length and width as it is stretched, m."""
        along, across = self.stretch.ratios if self.stretch else (1.0, 1.0)
        return self.length * along, self.width * across

    @property
    def maps(self) -> dict[str, Map]:
        """Its maps, by the keys of a scene file."""
        parts = {"top": self.top, "bottom": self.bottom, "foam": self.foam}
        return {f"skin.{name}.map": part.map for name, part in parts.items() if part.map}

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


class Contact(Table):
    """A foil strip on one electrode: an equipotential terminal along part of an edge.

    edge: left, right, bottom or top on a rectangle; "outline", "outline.3" (its third side),
    "hole1" or "hole1.2" on an outline; the name of a group of boundary lines on a mesh.
    """

    name: Name
    electrode: Electrode
    edge: Name
    span: tuple[Fraction, Fraction] = (0.0, 1.0)
    resistance: Annotated[Number, at_least_zero("ohm m")] = 0.0

    @property
    def ideal(self) -> bool:
        """Whether it holds its part of the edge at one potential."""
        return self.resistance == 0

    def ends(self, skin: Skin) -> tuple[tuple[float, float], tuple[float, float]]:
        """Both end points (x, y) in m, the low-coordinate end first; on outlines in their order.

        Foils on meshes are told by their facets instead.
        """
        if skin.outline is not None:
            along = section(self, skin)
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


class Interface(Table):
    """One way of connecting the meter; contacts in neither list float."""

    name: Name
    high: Annotated[tuple[str, ...], Field(min_length=1)]
    low: Annotated[tuple[str, ...], Field(min_length=1)]


class Pixels(Table):
    """The grid that presses are counted on.

    groups: on a mesh, the names of the groups of elements that pixels are, by row and column.
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
    """How a pixel is pressed: its capacitance over that at rest, and the spread between presses.

    factor_spread: standard deviation of the rise (factor - 1), as a fraction of that rise. depth
    [m] or force [N]: pixels are pressed mechanically, by a rigid flat applicator of their shape.
    """

    capacitance_factor: Annotated[Number, above_zero("times that at rest")] = 2.0
    factor_spread: Annotated[Number, Field(ge=0, lt=1)] = 0.0
    depth: Metre | None = None
    force: Annotated[Number, above_zero("N")] | None = None

    @property
    def plain(self) -> bool:
        """Whether pixels are pressed by a capacitance factor."""
        return self.depth is None and self.force is None

    @model_validator(mode="after")
    def _pressed_one_way(self) -> Self:
        asked = [name for name in PRESSED_BY if name in self.model_fields_set]
        given = [name for name in asked if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"takes one of {', '.join(PRESSED_BY)}, got {' and '.join(given)}")
        return self

    @model_serializer(mode="wrap")
    def _what_was_given(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        return kept if self.plain else {k: v for k, v in kept.items() if k != PRESSED_BY[0]}


class Scene(Table):
    """Everything that determines a simulated measurement."""

    name: Name
    description: str = ""
    skin: Skin
    contacts: Annotated[tuple[Contact, ...], Field(alias="contact", min_length=1)]
    interfaces: Annotated[tuple[Interface, ...], Field(alias="interface", min_length=1)]
    pixels: Pixels
    press: Pressing = Pressing()
    leads: Leads = Leads()
    sweep: Sweep
    readout: Readout = Readout()
    experiment: Experiment = Experiment()
    dataset: Randomisation = Randomisation()

    @property
    def frequencies(self) -> np.ndarray:
        """Hz, ascending, shape (frequency,)."""
        return np.array(self.sweep.frequencies)

    @property
    def beyond_plain(self) -> str | None:
        """The first key by which it is more than uniform sheets and foam on a rectangle at rest.

        None where there is none. What `electrical` folds in is one until then; bending to a
        cylinder never is one.
        """
        skin = self.skin
        keys = {
            "skin.outline": skin.outline is not None,
            "skin.mesh": skin.mesh is not None,
            "skin.stretch": skin.stretch is not None,
            "skin.shape": skin.shape is not None and not skin.shape.developable,
            **dict.fromkeys(skin.maps, True),
        }
        for name, sheet in (("top", skin.top), ("bottom", skin.bottom)):
            keys[f"skin.{name}.anisotropy"] = sheet.anisotropy is not None
            keys[f"skin.{name}.piezoresistance"] = sheet.piezoresistance != 0
        return next((key for key, there in keys.items() if there), None)

    @property
    def plain(self) -> bool:
        """Whether uniform sheets and foam on a rectangle at rest are all there is."""
        return self.beyond_plain is None

    @property
    def driven_by_touch(self) -> list[DrivenByTouch]:
        """Its contacts that float but touch driven ones; raises InputError for a mesh not read."""
        return driven_by_touch(self.contacts, self.interfaces, self.skin)

    def contact(self, name: str) -> Contact:
        """The contact of that name."""
        return next(contact for contact in self.contacts if contact.name == name)

    @model_validator(mode="after")
    def _mechanics_for_depth_and_force(self) -> Self:
        if not self.press.plain and self.skin.foam.mechanics is None:
            raise ValueError("`press` depth and force need the table skin.foam.mechanics")
        return self

    @model_validator(mode="after")
    def _contacts_and_interfaces_agree(self) -> Self:
        check_wiring(self.contacts, self.interfaces, self.skin)
        return self
