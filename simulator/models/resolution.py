"""Resolutions of increasing accuracy for a scene, a press and the highest frequency."""

from __future__ import annotations

import math

from ..fem.circuit import Circuit
from ..mesh.quadrilaterals import Resolution, singular_ends
from ..press.capacitance import lines, tile_map, touched_box
from ..press.press import Press
from ..press.touch import AnyTouch, Touch
from ..scene.contacts import Contact
from ..scene.parts import Skin
from ..scene.planar import Lines, distinct

ONE_CELL = [(order, 1) for order in (2, 3, 4, 5, 6, 7, 9)]
"""Orders with one cell in a pixel. 8 and 10 are left out: within a pixel most fields are nearly
uniform, so the next order hardly gains on them, and the difference underestimates the error at 10
by a factor of 1.3."""
SMOOTH = [*ONE_CELL, (6, 2), (8, 2), (10, 2), (8, 3), (10, 3)]
SINGULAR = [*ONE_CELL, (8, 2), (10, 2)]
RINGS_PER_ORDER, RINGS_AT_LEAST = 1.2, 3
FAINTEST = 1e-3
HARDER = 1e-3
"""Tolerance from which on ends of foils need one order more."""
LAYER_SHARE = 0.3
"""Share of the tolerance for the error of cells in layers."""
LAYER_TAKES, GAINED = 2.6, 90.0
"""Relative error of Rs and Cp by cells as wide as a layer is deep, over `GAINED`^-order."""


class ResolutionHierarchy:
    """Levels of resolution of one scene: elements of growing order, then smaller cells.

    Rings at ends of foils shrink with the order: they contribute 0.2^rings to the error, and
    elements of order p leave 0.15^p in each ring. The width of cells at contacted edges is
    proportional to the depth of the field and grows with the order: a polynomial of order p follows
    an exponential over p/4 of that depth.
    """

    def __init__(self, skin: Skin, circuit: Circuit, own: float | None = None) -> None:
        """own: tolerance of one press that shares no mesh with others.

        Its cells are as wide as this tolerance allows. Their width does not depend on the order, so
        that the next order reduces the error.
        """
        self.skin, self.circuit = skin, circuit
        contacts = circuit.contacts
        self.singular = bool(singular_ends(contacts, skin))
        self.levels = SINGULAR if self.singular else SMOOTH
        self._widths: float | None = None
        if own is not None:
            order, _ = ONE_CELL[self.lowest(own)]
            self._widths = (LAYER_SHARE * own / LAYER_TAKES * GAINED**order) ** (1 / (2 * order))

    def first(self, rtol: float) -> int:
        """First level to try: one that often suffices."""
        return max(0, min(round(-0.45 * math.log10(rtol) - 1.05), 4))

    def lowest(self, rtol: float) -> int:
        """First level, see `first`, for a press that is solved on one mesh after the other."""
        return self.first(rtol) + (self.singular and rtol <= HARDER)

    def resolution(self, level: int, press: Press, frequency: float) -> Resolution:
        """Mesh and order of a level, up to a frequency in Hz.

        The order is one more than the level's: one for the answer, and one to estimate its error.
        """
        order, cells = self.levels[level]
        factor = strongest(press, self.skin)
        depth = depth_of(self.skin, frequency)
        reached = self._reached(press, depth)
        layer = depth / math.sqrt(factor if reached.touches else 1.0) * self.followed(order)
        if self.halved(layer) == math.inf:
            reached = Press()
        return Resolution(
            order + 1,
            self._no_plane_of_symmetry(cells),
            math.ceil(RINGS_PER_ORDER * order) + RINGS_AT_LEAST if self.singular else 0,
            edge_cell=self.halved(layer),
            touch_cell=self.halved(layer) if reached.touches else math.inf,
            touched=all_lines(reached, self.skin),
            lines=lines(self.skin, press),
        )

    @property
    def _widest_pixel(self) -> float:
        skin, pixels = self.skin, self.skin.pixels
        return max(skin.length / pixels.columns, skin.width / pixels.rows)

    def _no_plane_of_symmetry(self, cells: int) -> int:
        """Number of cells with which no element spans the whole skin.

        Otherwise a plane of symmetry leaves every second order without effect.
        """
        pixels = self.skin.pixels
        return max(cells, 2 if 1 in (pixels.rows, pixels.columns) else 1)

    def followed(self, order: int) -> float:
        """Width of a cell over the depth of a layer that elements of that order represent."""
        return self._widths or max(1.0, order / 4)

    def halved(self, width: float) -> float:
        """Largest of a few fixed widths that is at most `width`; presses then share meshes.

        It is `width` itself for a press that shares no mesh.
        """
        if self._widths:
            return width
        skin = self.skin
        longest = max(skin.length, skin.width)
        if width >= self._widest_pixel:
            return math.inf
        return longest * 2.0 ** math.floor(math.log2(width / longest))

    def _reached(self, press: Press, depth: float) -> Press:
        """Touches near enough to a foil for the field to return from them."""
        return press.of(
            touch
            for touch in press.touches
            if touch.factor > 1 and reached_by_field(touch, self.skin, depth)
        )


def depth_of(skin: Skin, frequency: float) -> float:
    """Lower bound of the depth to which the field reaches from a foil at a frequency in Hz, m.

    Bodies charge the sheets as well: s G^-1 C of both sheets has no eigenvalue above its trace.
    """
    around = skin.around
    if around is None or not around.body:
        return skin.depth(frequency)
    R = {"top": skin.top.sheet_resistance, "bottom": skin.bottom.sheet_resistance}
    c = skin.foam.unpressed_capacitance_per_area
    charged = sum(R[body.side] * body.per_area for body in around.body)
    return skin.depth(frequency, 1 + charged / (skin.both_sheets * c))


def reached_by_field(touch: AnyTouch, skin: Skin, depth: float) -> bool:
    """True if a touch is near enough to a foil for a field of that depth in m to return from it."""
    return math.exp(-2 * _distance(touch, skin) / depth) > FAINTEST


def all_lines(press: Press, skin: Skin) -> Lines:
    """Lines at which c jumps by these touches, ascending."""
    boxes = [touched_box(skin, touch) for touch in press.touches]
    x, y = ({line for box in boxes for line in box[axis : axis + 2]} for axis in (0, 2))
    return tuple(sorted(x)), tuple(sorted(y))


def strongest(press: Press, skin: Skin) -> float:
    """Largest factor anywhere; where touches overlap, their product."""
    if all(isinstance(touch, Touch) for touch in press.touches):
        return max((touch.factor for touch in press.touches), default=1.0)
    x, y = (distinct(each) for each in all_lines(press, skin))
    return float(tile_map(skin, press, x, y).max())


def _distance(touch: AnyTouch, skin: Skin) -> float:
    """Distance from a touch to the nearest foil, m."""
    box, skin = touched_box(skin, touch), skin

    def gap(touched: tuple[float, float], contact: Contact, axis: int) -> float:
        low, high = (end[axis] for end in contact.ends(skin))
        return max(0.0, low - touched[1], touched[0] - high)

    return min(
        math.hypot(gap(box[:2], contact, 0), gap(box[2:], contact, 1)) for contact in skin.contacts
    )
