"""Touches that add a capacitance to earth, in a skin of one conductor.

A touch of C on an area A of a skin with c to earth multiplies c there by 1 + C / (c A).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from .draws.draw_distributions import AnyDistribution, Fixed, Normal, Uniform
from .ranges import MAX_FACTOR
from .validation import short

if TYPE_CHECKING:
    from .draws.randomisation import DrawnPress
    from .pixel_grid import Pixels, Pressing
    from .skin import SheetsAndFoam

Added = Literal["capacitance to earth"]
NEEDS_ONE_CONDUCTOR = (
    '`press.adds` needs `skin.bottom = "earth"`, a skin of one conductor; on two sheets a touch to '
    "earth is `press.finger` with [surroundings]"
)
UNSUITED = {
    "skin.outline": lambda skin: skin.outline is not None,
    "skin.mesh": lambda skin: skin.mesh is not None,
    "skin.stretch": lambda skin: skin.stretch is not None,
    "skin.foam.map": lambda skin: skin.foam.map is not None,
}
"""Keys with which equal touches of pixels are no equal factors."""


def per_pixel(skin: SheetsAndFoam, pixels: Pixels) -> float:
    """Capacitance of an unpressed pixel of a rectangular skin, F."""
    area = skin.length * skin.width / (pixels.rows * pixels.columns)
    return skin.foam.unpressed_capacitance_per_area * area


def with_factor(press: Pressing, skin: SheetsAndFoam, pixels: Pixels) -> Pressing:
    """The press with the factor of its capacitance.

    Raises ValueError naming the key that suits no such touch.
    """
    assert press.capacitance is not None
    if not skin.one_conductor:
        raise ValueError(NEEDS_ONE_CONDUCTOR)
    for key, given in UNSUITED.items():
        if given(skin):
            raise ValueError(f"`press.adds` needs a uniform rectangle, without `{key}`")
    own = per_pixel(skin, pixels)
    factor = 1 + press.capacitance / own
    if factor > MAX_FACTOR:
        raise ValueError(
            f"`press.capacitance` must be <= {short((MAX_FACTOR - 1) * own)} F, {MAX_FACTOR:g} "
            f"times the capacitance of an untouched pixel, got {short(press.capacitance)}"
        )
    return press.model_copy(update={"capacitance_factor": factor})


def with_drawn_factor(
    drawn: DrawnPress, press: Pressing, skin: SheetsAndFoam, pixels: Pixels
) -> DrawnPress:
    """Drawn presses with the factor of their capacitance, by default that of the scene's press.

    Raises ValueError for places and distributions that suit no such touch.
    """
    if drawn.place == "anywhere":
        raise ValueError('`dataset.press.place` must be "pixel" with `press.adds`')
    if drawn.offset and drawn.max_touches > 1:
        raise ValueError(
            "`dataset.press.offset` with `press.adds` needs `dataset.press.touches` of one touch "
            "at most: two displaced touches could overlap"
        )
    assert press.capacitance is not None
    capacitance = drawn.capacitance or Fixed(value=press.capacitance)
    own = per_pixel(skin, pixels)
    factor = _along(capacitance, lambda farad: 1 + farad / own)
    if not 1 <= factor.low <= factor.high <= MAX_FACTOR:
        raise ValueError(
            f"`dataset.press.capacitance` must be from 0 to {short((MAX_FACTOR - 1) * own)} F, got "
            f"{short(capacitance.low)} to {short(capacitance.high)}"
        )
    return drawn.model_copy(update={"capacitance": capacitance, "factor": factor})


def _along(drawn: AnyDistribution, line: Callable[[float], float]) -> AnyDistribution:
    """Distribution of a linear function of a drawn quantity."""
    match drawn:
        case Fixed():
            return Fixed(value=line(drawn.value))
        case Uniform():
            return Uniform(low=line(drawn.low), high=line(drawn.high))
        case Normal():
            deviation = line(drawn.deviation) - line(0.0)
            return Normal(mean=line(drawn.mean), deviation=deviation, cut=drawn.cut)
    raise ValueError("`dataset.press.capacitance` must be fixed, uniform or normal")
