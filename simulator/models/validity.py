"""Limits of the model of two sheets and a foam: effects that a scene leaves out, and their size.

Foam of thickness d carries displacement current along the skin too. Where the potential grows
uniformly from sheet to sheet that is a conductance s c d² / 12 in parallel with 1 / R. Its share is
|s R c| d² / 12 = (d / delta)² / 6; at the end of a long strip Rs falls and Cp rises by half as
much. At the edges of the skin the field fringes; at those of a press it is smoothed over d. Earth
takes a part of the current. `rcskin describe` computes these effects for a scene.
"""

from __future__ import annotations

import math

from ..scene.extent import perimeter, surface
from ..scene.foam import ASSUMED_PERMITTIVITY, VACUUM_PERMITTIVITY
from ..scene.parts import Pressing, Setup, Skin

LATERAL_LIMIT, FRINGE_LIMIT = 0.01, 0.1
PIXEL_LIMIT = 2.0


def rim_per_length(length: float, width: float, thickness: float) -> float:
    """Capacitance between two sheets along their rim beyond c times their area, F/m.

    gamma = eps0 / (2 pi) (1 + ln 2 pi (w / d + 1/2)), w = (L^-1.5 + W^-1.5)^(-2/3); all arguments
    in m. It holds for a floating meter and any permittivity of the foam: Kirchhoff's edge of two
    plates in air, with the smooth minimum w of both sides as their width. Error against a
    three-dimensional solve: 1 % for a square of w/d = 20, 5 % for a strip five times as long.
    """
    w = (length**-1.5 + width**-1.5) ** (-2 / 3)
    return VACUUM_PERMITTIVITY / (2 * math.pi) * (1 + math.log(2 * math.pi * (w / thickness + 0.5)))


def rim_share(skin: Skin) -> float:
    """Relative increase of C by the field around the outline: gamma P / C, P the perimeter.

    It is 2 gamma / c (1/L + 1/W) for a rectangle.
    """
    gamma = rim_per_length(*skin.stretched_sides, skin.foam.thickness_or_assumed)
    return gamma * perimeter(skin) / (skin.foam.unpressed_capacitance_per_area * surface(skin))


def straight_share(thickness: float, depth: float) -> float:
    """Bound on the relative change of Rs and Cp by fields in the foam that are not perpendicular.

    (d / delta)² / 6 with delta the depth to which the field reaches from a foil; both in m.
    """
    return (thickness / depth) ** 2 / 6


def describe_thickness(skin: Skin) -> str:
    """Thickness of the foam in words, with the assumption if only its capacitance is given."""
    thickness = f"{1e3 * skin.foam.thickness_or_assumed:.2g} mm"
    if skin.foam.thickness is not None:
        return thickness
    return f"{thickness} (relative permittivity {ASSUMED_PERMITTIVITY:g} assumed)"


def warnings(skin: Skin, setup: Setup, pressing: Pressing) -> list[str]:
    """One line for each limit of the model that the scene exceeds.

    A capacitance that is given directly is assumed to contain the fringe field, and the foam to be
    as thick as one of ASSUMED_PERMITTIVITY. The capacitance of one conductor to earth is that of
    its whole field: without a thickness there is no limit.
    """
    around = skin.around
    if skin.one_conductor and skin.foam.thickness is None:
        return []
    checks = [
        _assumed(skin),
        None if around and around.thickness else _lateral(skin, setup, pressing),
        None if around and (around.rim is not False or around.solved) else _fringe(skin),
        _pixels(skin),
    ]
    return [line for line in checks if line is not None]


def _assumed(skin: Skin) -> str | None:
    """Warning of an assumed thickness of the foam that surroundings need."""
    around = skin.around
    if around is None or skin.foam.thickness is not None:
        return None
    keys = [key for key in ("rim", "thickness", "solved") if getattr(around, key) is True]
    if not keys:
        return None
    return (
        f"`surroundings.{keys[0]}` assumes that the foam is {describe_thickness(skin)} thick; "
        "give skin.foam.thickness in addition to capacitance_per_area"
    )


def _lateral(skin: Skin, setup: Setup, pressing: Pressing) -> str | None:
    d = skin.foam.thickness_or_assumed
    depth = skin.depth(setup.frequency[-1], max(1.0, pressing.capacitance_factor))
    error = straight_share(d, depth)
    if error <= LATERAL_LIMIT:
        return None
    return (
        f"at {setup.frequency[-1]:.3g} Hz the field reaches {1e3 * depth:.2g} mm, not far "
        f"enough beyond the thickness of the foam, {describe_thickness(skin)}: currents along the "
        f"foam change Rs and Cp by up to {100 * error:.2g} % (limit {100 * LATERAL_LIMIT:g} %)"
    )


def _fringe(skin: Skin) -> str | None:
    foam, fringe = skin.foam, rim_share(skin)
    if foam.capacitance_per_area is not None or fringe <= FRINGE_LIMIT:
        return None
    return (
        f"fields around the edges add {100 * fringe:.2g} % to the capacitance of a foam "
        f"{describe_thickness(skin)} thick (limit {100 * FRINGE_LIMIT:g} %); give "
        "capacitance_per_area as measured, or [surroundings] rim = true"
    )


def _pixels(skin: Skin) -> str | None:
    pixels, d = skin.pixels, skin.foam.thickness_or_assumed
    pixel = min(skin.length / pixels.columns, skin.width / pixels.rows)
    if pixel >= PIXEL_LIMIT * d:
        return None
    return (
        f"pixels of {1e3 * pixel:.2g} mm are less than {PIXEL_LIMIT:g} times the foam's "
        f"{describe_thickness(skin)}: the edge of a press is not as sharp as modelled"
    )


def earth_left_out(skin: Skin) -> str | None:
    """Warning that a scene says nothing about earth, as one line; None if it does."""
    if skin.around is not None or skin.one_conductor:
        return None
    return (
        "the scene has no [surroundings]: a metal body behind the skin and a finger on it can "
        "change Rs by tens of percent; `rcskin describe` states by how much; add the table "
        '(low = "floating" for a meter without earth)'
    )
