"""Sizes of the effects that a model of two sheets and a foam leaves out: closed forms, estimates.

Relative sizes are those of a uniform skin with both sheets fed along the same edge, at low
frequency; the same formulas give the approximate size on other skins. eps0 is the permittivity of
vacuum, d the thickness of the foam, c its capacitance per area, C its whole capacitance.
"""

from __future__ import annotations

import math

from ..press.walls import step_capacitance
from ..scene.extent import perimeter, surface
from ..scene.foam.foam import VACUUM_PERMITTIVITY
from ..scene.readings.contacts import Contact
from ..scene.scene import Scene
from ..scene.skin import Electrode
from ..scene.surroundings import Body

NEARBY = Body(distance=5e-3)
"""A robot's arm behind a skin: the assumed body if a scene names none."""
FINGER = VACUUM_PERMITTIVITY * 3.0 * 1e-4 / 0.5e-3
"""Finger pad of 1 cm² on 0.5 mm of rubber or plastic of relative permittivity 3, 5.3 pF; F."""
OVERLAP = 1e-3
"""Assumed overlap of a foil if a scene names none, m."""


def rim_per_length(length: float, width: float, thickness: float) -> float:
    """Capacitance between two sheets along their rim beyond c times their area, F/m.

    gamma = eps0 / (2 pi) (1 + ln 2 pi (w / d + 1/2)), w = (L^-1.5 + W^-1.5)^(-2/3); all arguments
    in m. It holds for a floating meter and any permittivity of the foam: Kirchhoff's edge of two
    plates in air, with the smooth minimum w of both sides as their width. Error against a
    three-dimensional solve: 1 % for a square of w/d = 20, 5 % for a strip five times as long.
    """
    w = (length**-1.5 + width**-1.5) ** (-2 / 3)
    return VACUUM_PERMITTIVITY / (2 * math.pi) * (1 + math.log(2 * math.pi * (w / thickness + 0.5)))


def rim_share(scene: Scene) -> float:
    """Relative increase of C by the field around the outline: gamma P / C, P the perimeter.

    It is 2 gamma / c (1/L + 1/W) for a rectangle.
    """
    skin = scene.skin
    gamma = rim_per_length(*skin.stretched_sides, skin.foam.thickness_or_assumed)
    return gamma * perimeter(skin) / (skin.foam.unpressed_capacitance_per_area * surface(skin))


def straight_share(thickness: float, depth: float) -> float:
    """Bound on the relative change of Rs and Cp by fields in the foam that are not perpendicular.

    (d / delta)² / 6 with delta the depth to which the field reaches from a foil; both in m.
    """
    return (thickness / depth) ** 2 / 6


def wall_share(scene: Scene, factor: float) -> float:
    """Relative increase of a pixel's rise of capacitance by the walls around it.

    factor: k on the pixel's capacitance. E eps p / (c A (k - 1)) with perimeter p and area A of the
    pixel, and E of a step from d to d / k.
    """
    skin, (rows, columns) = scene.skin, scene.pixels.shape
    x, y = skin.stretched_sides[0] / columns, skin.stretched_sides[1] / rows
    step = float(step_capacitance(1 / factor)) * skin.foam.thickness_or_assumed
    return step * 2 * (x + y) / (x * y * (factor - 1))


def plate_capacitance(length: float, width: float) -> float:
    """C of a thin rectangular plate alone in space, F; sides in m.

    M. M. Yovanovich's shape factors of both sides of a plate, within 2 % up to sides of 5 to 1
    and 5 % up to 20 to 1 (0.36679 4 pi eps0 a of a square is known).
    """
    r = max(length, width) / min(length, width)
    if r <= 5:
        factor = math.sqrt(2) * (1 + math.sqrt(r)) ** 2 / math.sqrt(math.pi * r)
    else:
        factor = 2 * math.sqrt(2 * math.pi * r) / math.log(4 * r)
    return VACUUM_PERMITTIVITY * factor * math.sqrt(2 * length * width)


def open_share(scene: Scene) -> float:
    """Relative rise of Rs by a low terminal that is a virtual earth, without bodies nearby.

    Each sheet has half of the skin's capacitance as a plate alone in space. Rs is
    (L / 3W) (R_t (1 + C_te / C) + R_b (1 + C_be / C)).
    """
    return plate_capacitance(*scene.skin.stretched_sides) / 2 / capacitance(scene)


def body_share(scene: Scene, body: Body = NEARBY) -> float:
    """Relative rise of Rs by a body at earth.

    It is R_s / (R_t + R_b) C_e / C of the sheet s that the body faces, plus the rise by the
    capacitances of both sheets to earth without bodies nearby, see `open_share`.

    Against a three-dimensional solve, 5 mm behind the paper's sheet and strip: 22 % for 22.8 %, and
    26 % for 31 %; the field around the body's side of the rim is left out.
    """
    near = body.per_area / scene.skin.foam.unpressed_capacitance_per_area
    return sheet_part(scene, body.side) * near + open_share(scene)


def finger_share(scene: Scene, finger: float = FINGER) -> float:
    """Relative rise of Rs by a finger far from the foils, where it is largest. finger: F.

    dRs = R C_f c (L x - x²/2) / C² at a distance x from the foils, with R of the touched sheet. At
    x = L that is 3/2 R_s / (R_t + R_b) C_f / C of Rs.
    """
    touched = scene.surroundings.touched if scene.surroundings else "top"
    return 1.5 * sheet_part(scene, touched) * finger / capacitance(scene)


def overlap_share(extent: float, width: float) -> float:
    """Relative fall of Rs by foils that overlap the sheets: 1 - (1 - w / L)³.

    extent: L, of the skin from the foils' edge. width: w, of the overlap. Both in m.
    """
    return 1 - (1 - width / extent) ** 3


def extent_from(foil: Contact, scene: Scene) -> float:
    """Length of a skin from the edge that a foil is on, m; its shorter side on an outline."""
    x, y = scene.skin.stretched_sides
    return {"left": x, "right": x, "bottom": y, "top": y}.get(foil.edge, min(x, y))


def sheet_part(scene: Scene, electrode: Electrode) -> float:
    """Resistance of one sheet over that of both in series."""
    return scene.skin.sheet(electrode).sheet_resistance / scene.skin.both_sheets


def capacitance(scene: Scene) -> float:
    """Capacitance of the whole unpressed skin, with stretch, F; maps are left out."""
    skin = scene.skin
    stretched = math.prod(skin.stretch.ratios) if skin.stretch else 1.0
    return skin.foam.unpressed_capacitance_per_area * surface(skin) * stretched
