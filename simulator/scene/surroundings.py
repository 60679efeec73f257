"""What is around a skin: earth, bodies and covers near its sheets, and the fields at its rim.

Earth is the reference, 0 V. Everything here adds capacitance and no conductance.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    Strict,
    ValidationError,
    model_serializer,
    model_validator,
)

from .keys.key_paths import OrTable, OrText
from .ranges import Air, Distance, PerArea, PerLength, Permittivity, Thickness
from .skin import VACUUM_PERMITTIVITY, Electrode
from .validation import Table, one_line

SOLVED = {"low": "virtual earth", "solved": True}
"""What `surroundings = "solved"` is short for."""

LowTerminal = Literal["virtual earth", "floating"]
"""Of a meter: that of an LCR meter, or of one without earth."""

NO_EARTH = "needs the table [surroundings]: a finger's capacitance is that to earth"
NO_COVER = (
    "needs surroundings.cover or surroundings.air, of which its capacitance follows, or a "
    "capacitance in F in its place"
)
"""What is wrong with a finger in a scene that has none of these."""


class Body(Table):
    """A conducting plane that faces one sheet, such as the metal of a robot's arm.

    side: the electrode that faces it. distance [m]: from that sheet to the plane, away from the
    foam, with relative_permittivity for what lies between; or capacitance_per_area [F/m²] in place
    of both. potential: "earth"; "high" or "low", a guard that follows that terminal of the meter;
    or "floating".
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
        """Whether it is a guard that follows a terminal of the meter."""
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
    """The insulating layer between one sheet and the fingers that touch it.

    side: the electrode that fingers touch.
    """

    side: Electrode = "top"
    thickness: Thickness
    relative_permittivity: Permittivity


class Rim(Table):
    """Capacitance along the outline [F/m]: between the sheets, and of each sheet to earth."""

    mutual: PerLength = 0.0
    top: PerLength = 0.0
    bottom: PerLength = 0.0


def _rim(given: object) -> object:
    """A number is the capacitance between the sheets."""
    if isinstance(given, bool | Rim):
        return given
    if not isinstance(given, int | float | dict):
        raise ValueError(f"must be true, false, a number in F/m or a table, got {given!r}")
    table = given if isinstance(given, dict) else {"mutual": given}
    try:
        return Rim.model_validate(table)
    except ValidationError as error:
        raise ValueError(one_line(error, Rim)) from error


def _listed(given: object) -> object:
    return given if isinstance(given, list | tuple) else [given]


class Surroundings(Table):
    """What is around a skin; `surroundings = "solved"` is short for `{solved = true}`.

    low: the low terminal of the meter; "virtual earth" is that of an LCR meter, which holds it at
    the potential of earth and reads the current into it; "floating" is that of a meter without
    earth. rim: the capacitance of the field around the outline: true computes it, a number [F/m] is
    that between the sheets, a table gives that to earth, too. thickness: whether the field across
    the foam may be other than straight. edges: what walls add around touches of a factor; it needs
    thickness. solved: the charges of both sheets come from a
    three-dimensional solve, in place of the rim and of what each sheet has towards a body. air [m]:
    between the cover and a finger that hovers. body: one, or a list of two, one a side.
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
        """Why no finger can touch the skin, None where one can."""
        if self.low == "floating" and not self.reaches_earth:
            return (
                'finds no way back: `surroundings.low` = "floating" and nothing else reaches '
                "earth; give `surroundings.body` or `surroundings.rim`"
            )
        return self.shield_reason

    @property
    def shield_reason(self) -> str | None:
        """What is in front of the sheet that fingers touch, None where nothing is."""
        if any(each.side == self.touched for each in self.body):
            return (
                f"cannot touch the {self.touched} sheet, which has surroundings.body in front of "
                "it; surroundings.cover.side names the electrode that fingers touch"
            )
        return None

    @property
    def finger_per_area(self) -> float | None:
        """Capacitance of the touched sheet towards a finger, F/m²: the cover and the air in series.

        None where there is neither.
        """
        gap = self.air
        if self.cover is not None:
            gap += self.cover.thickness / self.cover.relative_permittivity
        return VACUUM_PERMITTIVITY / gap if gap else None

    def in_front_of(self, electrode: Electrode) -> Body | None:
        """The body that faces a sheet."""
        return next((each for each in self.body if each.side == electrode), None)

    @property
    def without_effect(self) -> bool:
        """Whether a meter reads the same without it, unless a finger touches.

        Earth alone makes no difference where nothing is charged against it.
        """
        return not (self.body or self.rim or self.thickness or self.solved)

    def at_earth(self, body: Body) -> bool:
        """Whether a body is at earth's potential, as what follows a virtual earth is."""
        return body.potential == "earth" or (
            body.potential == "low" and self.low == "virtual earth"
        )

    @property
    def for_rods(self) -> Surroundings | None:
        """What a meter reads the same with where no finger touches; None for nothing.

        A virtual earth that nothing else is charged against is a low terminal like any other: the
        form of both terminals at +1/2 V is 0.
        """
        if self.without_effect:
            return None
        grounded = any(self.at_earth(body) for body in self.body) or self.reaches_earth
        if self.low == "floating" or grounded or self.rim is True:
            return self
        return self.model_copy(update={"low": "floating"})

    @property
    def reaches_earth(self) -> bool:
        """Whether anything of it but a finger charges the sheets against earth.

        A rim that is computed for a meter that floats is one between the sheets alone.
        """
        rim = self.rim if isinstance(self.rim, Rim) else None
        return (
            any(body.potential == "earth" for body in self.body)
            or self.solved
            or (rim is not None and rim.top + rim.bottom > 0)
        )

    @property
    def symmetric_sides(self) -> bool:
        """Whether both sheets see the same."""
        one, other = (self.in_front_of(electrode) for electrode in ("top", "bottom"))
        alike = one is None or other is None or one.model_copy(update={"side": other.side}) == other
        rim = not isinstance(self.rim, Rim) or self.rim.top == self.rim.bottom
        return (one is None) == (other is None) and alike and rim

    @model_validator(mode="after")
    def _parts_go_together(self) -> Self:
        if len(self.body) == 2 and self.body[0].side == self.body[1].side:
            raise ValueError(f"takes one body on each side, got two on the {self.body[0].side}")
        if self.edges and not self.thickness:
            raise ValueError("takes edges with thickness = true only")
        if self.solved and self.rim is not False:
            raise ValueError("takes solved or rim, got both: what is solved has the rim in it")
        if self.cover is not None and self.shield_reason:
            raise ValueError(f"has a cover where a finger {self.shield_reason}")
        return self

    @model_serializer(mode="wrap")
    def _bodies_as_given(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        if len(self.body) < 2:
            kept["body"] = kept["body"][0] if kept["body"] else None
        return {key: value for key, value in kept.items() if value is not None}


def _short(given: object) -> object:
    """The text `solved` in place of a table."""
    if isinstance(given, str):
        if given != "solved":
            raise ValueError(f"must be a table or 'solved', got {given!r}")
        return SOLVED
    return given


AnySurroundings = Annotated[Surroundings, BeforeValidator(_short), OrText('`"solved"`')]
