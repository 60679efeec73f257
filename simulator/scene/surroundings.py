"""Surroundings of a skin: earth, bodies and covers near its sheets, and the field at its rim.

Earth is the reference, 0 V. All surroundings add capacitance and no conductance.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    Strict,
    model_serializer,
    model_validator,
)

from .foam import VACUUM_PERMITTIVITY
from .keys import OrTable, OrText
from .ranges import Air, Distance, PerArea, PerLength, Permittivity, Thickness
from .skin import Electrode
from .validation import Table, validated

SOLVED = {"low": "virtual earth", "solved": True}
"""The table for which `surroundings = "solved"` is short."""

LowTerminal = Literal["virtual earth", "floating"]
"""Low terminal of a meter: that of an LCR meter, or of one without earth."""

NO_EARTH = "needs the table [surroundings]: a finger's capacitance is that to earth"
NO_COVER = (
    "needs surroundings.cover or surroundings.air, of which its capacitance follows, or a "
    "capacitance in F in its place"
)
"""Messages for a finger in a scene without surroundings, and without cover and air."""


class Body(Table):
    """A conducting plane that faces one sheet, such as the metal of a robot's arm.

    side: the electrode that faces the body. distance [m]: from that sheet to the plane, away from
    the foam. relative_permittivity: of the material between them. capacitance_per_area [F/m²]: in
    place of both. potential: "earth"; "high" or "low", a guard that follows that terminal of the
    meter; or "floating".
    """

    side: Electrode = "bottom"
    distance: Distance | None = None
    relative_permittivity: Permittivity = 1.0
    capacitance_per_area: PerArea | None = None
    potential: Literal["earth", "high", "low", "floating"] = "earth"

    @property
    def per_area(self) -> float:
        """Capacitance between the sheet and the plane, F/m²."""
        if self.capacitance_per_area is not None:
            return self.capacitance_per_area
        assert self.distance is not None
        return VACUUM_PERMITTIVITY * self.relative_permittivity / self.distance

    @property
    def follows(self) -> bool:
        """True if the body is a guard that follows a terminal of the meter."""
        return self.potential in ("high", "low")

    @model_validator(mode="after")
    def _one_way_to_the_capacitance(self) -> Self:
        if (self.distance is None) == (self.capacitance_per_area is None):
            raise ValueError("needs either distance or capacitance_per_area")
        if self.distance is None and "relative_permittivity" in self.model_fields_set:
            raise ValueError("takes relative_permittivity with distance only")
        return self

    @model_serializer(mode="wrap")
    def _what_counts(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        if self.distance is None:
            del kept["relative_permittivity"]
        return kept


class Cover(Table):
    """The insulating layer between one sheet and a finger.

    side: the electrode that fingers touch. thickness: of the layer. relative_permittivity: of its
    material.
    """

    side: Electrode = "top"
    thickness: Thickness
    relative_permittivity: Permittivity


class Rim(Table):
    """Capacitance along the outline [F/m]: between the sheets, and of each sheet to earth.

    mutual: between the sheets. top: of the top sheet to earth. bottom: of the bottom sheet to
    earth.
    """

    mutual: PerLength = 0.0
    top: PerLength = 0.0
    bottom: PerLength = 0.0


def _rim(given: object) -> object:
    """Converts a table or a number, the capacitance between the sheets, to a rim."""
    if isinstance(given, bool | Rim):
        return given
    if not isinstance(given, int | float | dict):
        raise ValueError(f"must be true, false, a number in F/m or a table, got {given!r}")
    table = given if isinstance(given, dict) else {"mutual": given}
    return validated(Rim, table)


def _listed(given: object) -> object:
    return given if isinstance(given, list | tuple) else [given]


class Surroundings(Table):
    """Surroundings of a skin; `surroundings = "solved"` is short for `{solved = true}`.

    low: low terminal of the meter. "virtual earth" is that of an LCR meter, which keeps it at the
    potential of earth and reads the current into it; "floating" is that of a meter without earth.
    rim: capacitance of the field around the outline. true computes it, a number [F/m] is that
    between the sheets, a table also gives that to earth. thickness: true allows a field in the foam
    that is not perpendicular to the sheets. edges: true adds the excess capacitance of the walls
    around touches by a factor; it needs thickness. solved: true computes the charges of both sheets
    by a three-dimensional solve, in place of the rim and of the capacitance of each sheet to a
    body. air [m]: between the cover and a hovering finger. body: one body, or a list of two, one on
    each side.
    """

    low: LowTerminal = "virtual earth"
    rim: Annotated[bool | Rim, BeforeValidator(_rim), OrText("number")] = False
    thickness: Annotated[bool, Strict()] = False
    edges: Annotated[bool, Strict()] = False
    solved: Annotated[bool, Strict()] = False
    air: Air = 0.0
    body: Annotated[
        tuple[Body, ...], BeforeValidator(_listed), OrTable(Body), Field(max_length=2)
    ] = ()
    cover: Cover | None = None

    @property
    def touched(self) -> Electrode:
        """The electrode that fingers touch."""
        return self.cover.side if self.cover else "top"

    @property
    def no_finger_reason(self) -> str | None:
        """Reason why no finger can touch the skin; None if one can."""
        if self.low == "floating" and not self.reaches_earth:
            return (
                'has no return path: `surroundings.low` = "floating" and nothing else reaches '
                "earth; give `surroundings.body` or `surroundings.rim`"
            )
        return self.shield_reason

    @property
    def shield_reason(self) -> str | None:
        """Message about a body in front of the sheet that fingers touch; None if there is none."""
        if any(each.side == self.touched for each in self.body):
            return (
                f"cannot touch the {self.touched} sheet, which has surroundings.body in front of "
                "it; surroundings.cover.side names the electrode that fingers touch"
            )
        return None

    @property
    def finger_per_area(self) -> float | None:
        """Capacitance of the touched sheet to a finger, F/m²: cover and air in series.

        None if there is neither.
        """
        gap = self.air
        if self.cover is not None:
            gap += self.cover.thickness / self.cover.relative_permittivity
        return VACUUM_PERMITTIVITY / gap if gap else None

    def in_front_of(self, electrode: Electrode) -> Body | None:
        """The body that faces a sheet; None if there is none."""
        return next((each for each in self.body if each.side == electrode), None)

    @property
    def without_effect(self) -> bool:
        """True if readings without a finger are equal to those without surroundings.

        Earth alone makes no difference if nothing is charged against it.
        """
        return not (self.body or self.rim or self.thickness or self.solved)

    def at_earth(self, body: Body) -> bool:
        """True if a body is at the potential of earth; a guard on a virtual earth is as well."""
        return body.potential == "earth" or (
            body.potential == "low" and self.low == "virtual earth"
        )

    @property
    def for_rods(self) -> Surroundings | None:
        """Simplest surroundings with equal readings if no finger touches; None for no surroundings.

        A virtual earth against which nothing else is charged is equivalent to a floating low
        terminal: the quadratic form of both terminals at +1/2 V is 0.
        """
        if self.without_effect:
            return None
        grounded = any(self.at_earth(body) for body in self.body) or self.reaches_earth
        if self.low == "floating" or grounded or self.rim is True:
            return self
        return self.model_copy(update={"low": "floating"})

    @property
    def reaches_earth(self) -> bool:
        """True if the sheets are charged against earth by anything but a finger.

        A computed rim for a floating meter has only the capacitance between the sheets.
        """
        rim = self.rim if isinstance(self.rim, Rim) else None
        return (
            any(body.potential == "earth" for body in self.body)
            or self.solved
            or (rim is not None and rim.top + rim.bottom > 0)
        )

    @property
    def symmetric_sides(self) -> bool:
        """True if both sheets have equal surroundings."""
        one, other = (self.in_front_of(electrode) for electrode in ("top", "bottom"))
        same_body = (
            one is None or other is None or one.model_copy(update={"side": other.side}) == other
        )
        rim = not isinstance(self.rim, Rim) or self.rim.top == self.rim.bottom
        return (one is None) == (other is None) and same_body and rim

    @model_validator(mode="after")
    def _parts_go_together(self) -> Self:
        if len(self.body) == 2 and self.body[0].side == self.body[1].side:
            raise ValueError(f"takes one body on each side, got two on the {self.body[0].side}")
        if self.edges and not self.thickness:
            raise ValueError("takes edges with thickness = true only")
        if self.solved and self.rim is not False:
            raise ValueError("takes solved or rim, got both: solved includes the rim")
        if self.cover is not None and self.shield_reason:
            raise ValueError(f"has a cover, but a finger {self.shield_reason}")
        return self

    @model_serializer(mode="wrap")
    def _bodies_as_given(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        if len(self.body) < 2:
            kept["body"] = kept["body"][0] if kept["body"] else None
        return {key: value for key, value in kept.items() if value is not None}


def _short(given: object) -> object:
    """Converts the text `solved` to a table."""
    if isinstance(given, str):
        if given != "solved":
            raise ValueError(f"must be a table or 'solved', got {given!r}")
        return SOLVED
    return given


AnySurroundings = Annotated[Surroundings, BeforeValidator(_short), OrText('`"solved"`')]


def check_finger(finger: str | float | None, around: Surroundings | None) -> None:
    """Raises ValueError if the finger of a press has no way to earth, or no known capacitance."""
    if finger is None:
        return
    if around is None:
        raise ValueError(f"`press.finger` {NO_EARTH}")
    if around.no_finger_reason:
        raise ValueError(f"`press.finger` {around.no_finger_reason}")
    if isinstance(finger, str) and around.finger_per_area is None:
        raise ValueError(f"`press.finger` = {finger!r} {NO_COVER}")
