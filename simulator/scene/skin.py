"""The skin: two electrode sheets around a foam.

Lengths are in m, resistances in ohm. x runs along `length`, y along `width`; pixel (1, 1) lies at
the corner x = y = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    WrapSerializer,
    model_validator,
)

from .factor_maps import FactorMap, SheetMap, Tear
from .foam import Foam
from .form import Outline, Shape, Stretch, check_outline
from .frequency import penetration_depth
from .keys import OrText
from .mesh_data import MeshData, check_extent, read_along
from .ranges import Angle, Length, Piezoresistance, SheetResistance
from .validation import Number, Table, short, single_line

MIN_DEPTH = 1e-6
"""Smallest penetration depth of the field from a foil, over the skin's longer side.

Mesh cells near the foil are as narrow. At half of it results are still accurate, after half a
minute; at a tenth of it there is none within minutes."""

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

    sheet_resistance: nominal value, which `map` multiplies. piezoresistance: relative rise of the
    sheet resistance per unit of compressive strain of the foam beneath. map: factor by position, or
    a tear.
    """

    sheet_resistance: SheetResistance
    piezoresistance: Piezoresistance = 0.0
    anisotropy: Anisotropy | None = None
    map: SheetMap | None = None


EARTH: Literal["earth"] = "earth"
"""Text in place of the table `skin.bottom`, and of the list `low` of an interface."""
EARTH_RESISTANCE = 1e-6
"""Sheet resistance of earth, ohm/sq: that of 1 cm of copper, the smallest of all sheets."""


class Earth(Sheet):
    """Earth in place of the bottom sheet; one field of such a skin has the top sheet's resistance.

    Two fields are solved with EARTH_RESISTANCE, which is none beside that of the top sheet.
    """

    sheet_resistance: SheetResistance = EARTH_RESISTANCE


def _sheet_or_earth(given: object) -> object:
    if isinstance(given, str):
        if given != EARTH:
            raise ValueError(f"must be a table or {EARTH!r}, got {given!r}")
        return Earth()
    return given


def _written(sheet: Sheet, everything: SerializerFunctionWrapHandler) -> Any:
    return EARTH if isinstance(sheet, Earth) else everything(sheet)


BottomSheet = Annotated[
    Sheet, BeforeValidator(_sheet_or_earth), WrapSerializer(_written), OrText('`"earth"`')
]


class SheetsAndFoam:
    """What follows from the sheets and the foam of a skin, in its table and in `parts.Skin`."""

    if TYPE_CHECKING:
        length: float
        width: float
        outline: Outline | None
        mesh: MeshData | None
        top: Sheet
        bottom: Sheet
        foam: Foam
        stretch: Stretch | None
        shape: Shape | None

    def with_parts(self, **changed: Any) -> Self:
        """The skin with changed fields."""
        raise NotImplementedError

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
        """Resistance of both sheets in series, ohm/sq; earth has none."""
        return self.top.sheet_resistance if self.one_conductor else sum(self.sheet_resistances)

    @property
    def one_conductor(self) -> bool:
        """True if the bottom sheet is earth."""
        return isinstance(self.bottom, Earth)

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
        depth, smallest = self.depth(frequency, factor), MIN_DEPTH * max(self.sides)
        if depth < smallest:
            raise ValueError(
                f"`sweep.frequencies`: at {short(frequency)} Hz the field reaches {short(depth)} m "
                f"from the foils; it must reach {short(smallest)} m, {short(MIN_DEPTH)} of the "
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
    def maps(self) -> dict[str, FactorMap]:
        """Maps of the sheets and of the foam by their keys in a scene file."""
        parts = {"top": self.top, "bottom": self.bottom, "foam": self.foam}
        return {f"skin.{name}.map": part.map for name, part in parts.items() if part.map}

    @property
    def torn(self) -> bool:
        """True if a sheet of a rectangle is torn."""
        rectangle = self.outline is None and self.mesh is None
        return rectangle and any(isinstance(each.map, Tear) for each in (self.top, self.bottom))

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


class SkinTable(SheetsAndFoam, Table):
    """Two electrode sheets around a foam; length and width are those before stretching.

    The skin is a rectangle, or has an outline, or comes from a mesh file. With an outline or a
    mesh, the grid of pixels lies on the rectangle of length and width. length: along x, from the
    left edge to the right. width: along y, from the bottom edge to the top. mesh: a mesh, or the
    path of its file from the folder of the scene file. bottom: the lower electrode sheet; "earth"
    is a skin of one conductor, the top sheet, whose capacitance to earth is
    foam.capacitance_per_area. top: the upper electrode sheet. shape: the surface to which the skin
    is bent, a cylinder or a sphere.
    """

    length: Length
    width: Length
    outline: Outline | None = None
    mesh: AnyMesh = None
    top: Sheet
    bottom: BottomSheet
    foam: Foam
    stretch: Stretch | None = None
    shape: Shape | None = None

    def with_parts(self, **changed: Any) -> Self:
        """The skin with changed fields."""
        return self.model_copy(update=changed)

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
