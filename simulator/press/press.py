"""A press: simultaneous touches of the skin, their text form, and where they may lie."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass, replace

import numpy as np

from ..scene.form import check_simple
from ..scene.parts import Pressing, Skin
from ..scene.pixel_grid import per_pixel
from ..scene.planar import SAME_LINE
from ..scene.surroundings import NO_EARTH
from ..sweeps import UNPRESSED, InputError
from ..sweeps.press_text import FREE_TOUCH, WrittenStrength, WrittenTouch, parse_touches
from .finger import finger_of, touched_area
from .pixels import pixels_with_skin
from .touch import (
    AnyTouch,
    Depth,
    Disc,
    Force,
    Indentation,
    Place,
    Polygon,
    Rectangle,
    Strength,
    Touch,
    place_of,
    touch_at,
)

PICOFARAD_DECIMALS = 6
"""Decimals of capacitances that touches add, in pF."""
ORDER = (Touch, Rectangle, Disc, Polygon)


@dataclass(frozen=True)
class Press:
    """Several touches at once; none is the unpressed skin.

    Pixels are pressed once each; other touches may overlap them and each other. Where touches
    overlap, factors multiply, or with `adds` their rises add up, as capacitances to earth do on a
    skin of one conductor; of applicators the deeper one counts.
    """

    touches: tuple[AnyTouch, ...] = ()
    adds: bool = False

    def __str__(self) -> str:
        return "+".join(map(str, self.touches)) or UNPRESSED

    def of(self, touches: Iterable[AnyTouch]) -> Press:
        """Press of other touches, which act together as these do."""
        touches = tuple(touches)
        return Press(touches, self.adds and len(touches) > 1)

    @property
    def plain(self) -> bool:
        """True if all touches are factors of pixels and rectangles, by rods."""
        return not self.fingers and self.boxes

    @property
    def fingers(self) -> bool:
        """True if any touch has a capacitance to earth."""
        return any(touch.finger for touch in self.touches)

    @property
    def boxes(self) -> bool:
        """True if all touches are factors of pixels and rectangles, by rods or fingers."""
        return all(isinstance(touch, Touch | Rectangle) for touch in self.touches)

    @property
    def on_patches(self) -> Press:
        """Press of its touches of a given factor, and of fingers at the others, with factor 1."""
        patches = [replace(t.place, finger=t.finger) for t in self.indented if t.finger]
        return self.of((*self.sharp.touches, *patches))

    @property
    def sharp(self) -> Press:
        """Press of its touches of a given factor."""
        return self.of(each for each in self.touches if not isinstance(each, Indentation))

    @property
    def indented(self) -> tuple[Indentation, ...]:
        """Touches of a given depth or force."""
        return tuple(each for each in self.touches if isinstance(each, Indentation))

    @property
    def pixel(self) -> tuple[int, int]:
        """(row, column) of a single touch, (0, 0) unpressed, (-1, -1) if it is no single pixel."""
        if not self.touches:
            return 0, 0
        first, *others = self.touches
        place = place_of(first)
        if others or not isinstance(place, Touch):
            return -1, -1
        return place.row, place.column


def require_plain(press: Press) -> None:
    """Raise InputError unless all touches are factors of pixels and rectangles, by rods."""
    if not press.plain:
        raise InputError(
            f"press {press}: must be capacitance factors of pixels or rect here, "
            "without depth, force, disc, poly or finger"
        )


def parse_press(
    text: str, default: Strength, skin: Skin | None = None, pressing: Pressing | None = None
) -> Press:
    """Press from `text`, see `sweeps.press_text`.

    `default`: strength of touches without one of their own. Touches without a finger of their own
    have that of the pressing on the skin, and are rods without them. Touches are sorted: factors
    before depths and forces, pixels before rectangles, discs and polygons. Raises what
    `parse_touches` raises, and InputError for a finger whose capacitance no skin gives.
    """
    adds = skin is not None and pressing is not None and pressing.adds is not None
    touches = [_touch(each, default, skin, pressing) for each in parse_touches(text)]
    return Press(adds=adds).of(sorted(touches, key=order))


def _touch(
    written: WrittenTouch, default: Strength, skin: Skin | None, pressing: Pressing | None
) -> AnyTouch:
    place = _place(written)
    if skin is not None and pressing is not None and pressing.adds:
        return touch_at(place, added_factor(skin, place, written, default))
    strength = default if written.strength is None else _parsed_strength(written.strength)
    given = pressing.finger if pressing else None
    return touch_at(place, strength, finger_of(place, written.finger, given, skin))


def added_factor(skin: Skin, place: Place, written: WrittenTouch, default: Strength) -> Strength:
    """Factor of a touch of a scene with `press.adds`. default: that of a touch without its own.

    Raises InputError for a factor with a capacitance.
    """
    strength, finger = written.strength, written.finger
    if strength is not None and finger is None:
        return _parsed_strength(strength)
    if strength is not None and finger != FREE_TOUCH:
        raise InputError(
            f"a touch adds a capacitance to earth in {skin.name}: {place.where} takes one such as "
            ":30pF, or a factor, got both"
        )
    if not isinstance(finger, float):
        return default
    return 1 + finger / capacitance_of(skin, place)


def capacitance_of(skin: Skin, place: Place) -> float:
    """Capacitance of a place without a touch, F."""
    if isinstance(place, Touch):
        return per_pixel(skin, skin.pixels)
    return skin.foam.unpressed_capacitance_per_area * touched_area(skin, place)


def order(touch: AnyTouch) -> tuple:
    """Sort key of the touches of a press."""
    place = place_of(touch)
    by = (touch.by.unit, touch.by.value) if isinstance(touch, Indentation) else ()
    return bool(by), ORDER.index(type(place)), astuple(place), by, touch.finger


def _place(touch: WrittenTouch) -> Place:
    """Place from its text, of factor 1."""
    numbers = touch.numbers
    match touch.kind:
        case "pixel":
            return Touch(*touch.pixel, 1.0)
        case "rect":
            x, y, width, height = numbers
            return Rectangle(x, y, width, height, 1.0)
        case "disc":
            x, y, radius = numbers
            return Disc(x, y, radius, 1.0)
        case "poly":
            return Polygon(tuple(zip(numbers[::2], numbers[1::2], strict=True)), 1.0)


def _parsed_strength(strength: WrittenStrength) -> Strength:
    kinds = {"m": Depth, "N": Force}
    return kinds[strength.unit](strength.value) if strength.unit else strength.value


MIN_TOUCH_SIZE = 1e-6
"""Smallest size of a touch over that of the skin: a thousand times the distance at which lines
coincide."""


def strength_of(pressing: Pressing) -> Strength:
    """Strength of a touch without one of its own."""
    if pressing.depth is not None:
        return Depth(pressing.depth)
    return pressing.capacitance_factor if pressing.force is None else Force(pressing.force)


def pixel_pressed(skin: Skin, pressing: Pressing, row: int, column: int, factor: float) -> AnyTouch:
    """Pixel with this factor of c under it: by a depth if the scene presses by depth.

    Raises InputError if the foam cannot be compressed so far.
    """
    pixel = Touch(row, column, 1.0)
    strength = factor if pressing.by_factor else Depth(skin.pressed_depth(factor))
    return touch_at(pixel, strength, finger_of(pixel, None, pressing.finger, skin))


def pressed_factor(skin: Skin, touch: AnyTouch) -> float:
    """c under a touch over its unpressed value. Raises InputError for a force."""
    if not isinstance(touch, Indentation):
        return touch.factor
    return skin.factor_at(touch.by.value if isinstance(touch.by, Depth) else None)


def every_press(skin: Skin, pressing: Pressing) -> list[Press]:
    """The unpressed skin, then each pixel with skin alone, row by row."""
    strength = strength_of(pressing)
    pixels = [Touch(row, column, 1.0) for row, column in pixels_with_skin(skin)]
    fingers = [finger_of(each, None, pressing.finger, skin) for each in pixels]
    pressed = [touch_at(p, strength, f) for p, f in zip(pixels, fingers, strict=True)]
    return [Press(), *(Press((touch,)) for touch in pressed)]


def press_on(skin: Skin, pressing: Pressing, text: str) -> Press:
    """Press from `text`; touches without a strength have that of the scene.

    Raises what `parse_press` and `check_press` raise.
    """
    press = parse_press(text, strength_of(pressing), skin, pressing)
    return check_press(press, skin)


def label_of(press: Press, skin: Skin, pressing: Pressing) -> str:
    """Text of the press that `press_on` reads as the same press.

    It is that of `Press`, but a rod is named if touches of the scene are fingers by default, and
    touches that add a capacitance to earth are written by it.
    """
    if pressing.adds:
        return "+".join(_added(touch, skin) for touch in press.touches) or UNPRESSED
    rod = rod_text(pressing)
    return "+".join(f"{t}{'' if t.finger else rod}" for t in press.touches) or UNPRESSED


def _added(touch: AnyTouch, skin: Skin) -> str:
    rise = pressed_factor(skin, touch) - 1
    if rise < 0:
        return str(touch)
    return f"{touch.where}:{in_picofarad(rise * capacitance_of(skin, place_of(touch)))!r}pF"


def in_picofarad(capacitance: float) -> float:
    """A capacitance in F in pF, as in the text of a press."""
    return round(1e12 * capacitance, PICOFARAD_DECIMALS)


def rod_text(pressing: Pressing) -> str:
    """Ending of the text of a touch by a rod."""
    return ":rod" if pressing.finger else ""


def check_press(press: Press, skin: Skin) -> Press:
    """The press, if it lies on the scene's skin; raises InputError."""
    for place in map(place_of, press.touches):
        if isinstance(place, Touch):
            _check_pixel(place, press, skin)
        else:
            _check_place(place, press, skin)
        if isinstance(place, Polygon):
            _check_polygon(place, press, skin)
    if press.indented and skin.foam.mechanics is None:
        raise InputError(
            f"press {press}: depth and force need the table skin.foam.mechanics in {skin.name}"
        )
    check_fingers(press, skin)
    return press


def check_fingers(press: Press, skin: Skin) -> None:
    """Raise InputError for fingers if the scene has no earth, or a body covers the touched
    sheet."""
    around = skin.around
    reason = NO_EARTH if around is None else around.no_finger_reason
    if press.fingers and reason is not None:
        raise InputError(f"press {press} on {skin.name}: a finger {reason}")


def _check_polygon(touch: Polygon, press: Press, skin: Skin) -> None:
    least = MIN_TOUCH_SIZE * max(skin.length, skin.width)
    try:
        check_simple("poly", np.array(touch.points), least)
    except ValueError as error:
        raise InputError(f"press {press}: {error}") from error


def _check_pixel(touch: Touch, press: Press, skin: Skin) -> None:
    for axis, index, count in (
        ("row", touch.row, skin.pixels.rows),
        ("column", touch.column, skin.pixels.columns),
    ):
        if not 1 <= index <= count:
            raise InputError(
                f"press {press}: {axis} must be in 1..{count} on {skin.name}, got {index}"
            )


def _check_place(touch: Rectangle | Disc | Polygon, press: Press, skin: Skin) -> None:
    box, skin = touch.box, skin
    for axis, length, low, high in (
        ("x", skin.length, box.left, box.right),
        ("y", skin.width, box.bottom, box.top),
    ):
        rounding = SAME_LINE * length
        if low < -rounding or high > length + rounding:
            raise InputError(
                f"press {press}: touches must lie within {axis} = 0..{length:g} m on {skin.name}, "
                f"got {low:g}..{high:g} m{_suggestion_in_mm(touch, skin)}"
            )
        if not high - low >= MIN_TOUCH_SIZE * length:
            raise InputError(
                f"press {press}: touches must be at least {MIN_TOUCH_SIZE * length:g} m large "
                f"along {axis} on {skin.name}, got {high - low:g} m"
            )


def _suggestion_in_mm(touch: Rectangle | Disc | Polygon, skin: Skin) -> str:
    """Suggests the touch in metres if it lies on the skin when its numbers are millimetres."""
    if isinstance(touch, Polygon):
        small = replace(touch, points=tuple((x / 1000, y / 1000) for x, y in touch.points))
    else:
        lengths = {"x", "y", "width", "height", "radius"} & vars(touch).keys()
        small = replace(touch, **{name: getattr(touch, name) / 1000 for name in lengths})
    box = small.box
    fits = box.left >= 0 and box.right <= skin.length and box.bottom >= 0 and box.top <= skin.width
    return f"; did you mean mm, {small.where}?" if fits else ""
