"""Training cases of a reduced model: random presses on skins of the family."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Integer, Mask, Real
from ...mesh.pixel_coverage import pixel_coverage
from ...press.finger import finger_of
from ...press.parts import foam_parts, parts_of
from ...press.pixels import pixels_with_skin
from ...press.press import Press
from ...press.touch import Touch
from ...scene.parts import Plan, Skin
from ..heterogeneous.materials import gauged
from ..parameters import Variation

TWICE = 2


@dataclass(frozen=True)
class Case:
    """A press on a skin of the family: the touched pixels and the rises of c there.

    variation: None for the scene's own skin. cells: row * columns + column, from 0; fingers and
    other parts that a press may change beyond the pixels are numbered as in `Parts`.
    """

    variation: Variation | None
    cells: Integer
    rises: Real

    def only(self, kept: Mask) -> Case:
        """The case with some of its cells; kept: shape (cell,)."""
        return replace(self, cells=self.cells[kept], rises=self.rises[kept])

    def press_on(self, skin: Skin) -> Press:
        """Press of the case's pixels by capacitance factors, with the fingers on them."""
        columns, parts = skin.pixels.columns, parts_of(skin)
        of = dict(zip(self.cells.tolist(), self.rises.tolist(), strict=True))
        pixels = dict.fromkeys(k if k < parts.foam else k - parts.foam for k in of)
        return Press(
            tuple(
                Touch(
                    k // columns + 1,
                    k % columns + 1,
                    1 + of.get(k, 0.0),
                    of.get(parts.foam + k, 0.0),
                )
                for k in pixels
            )
        )


def touched(skin: Skin, cells: Integer, rises: Real) -> Real:
    """Factors on c by touches, shape (part,), see `foam_parts`."""
    factors = np.ones(foam_parts(skin))
    on_foam = cells < len(factors)
    np.add.at(factors, cells[on_foam], rises[on_foam])
    return factors


Draw = Callable[[np.random.Generator], Case]

MAX_PIXELS_AT_ONCE = 2
"""Largest number of pixels that one press touches."""


LARGEST_FINGER = 10e-12
"""Capacitance of a finger up to which every model is trained, F. It is twice eps0 A / t = 5.1 pF of
a finger on 576 mm² behind 1 mm of air. A scene that names stronger fingers is trained beyond it."""


BEYOND_NAMED = 1.25
"""Fingers are drawn up to this factor times the strongest one that a scene names."""
AT_ENDS = 0.25
"""Fingers are drawn beyond either end of their range by this share of it, and clipped to that end.
The same share of touches does not press. So some draws are fingers at an end that only touch."""


def pixel_touches(skin: Skin, plan: Plan, factor: tuple[float, float] = (1.0, 3.0)) -> Draw:
    """Draw of one or several random pixels on the scene's own skin, with factors in a range.

    If the scene has an earth, fingers of any capacitance up to `strongest_finger` press them.
    """
    pixels, parts = skin.pixels.rows * skin.pixels.columns, parts_of(skin)
    strongest = strongest_finger(skin, plan) if parts.fingers else 0.0

    def draw(random: np.random.Generator) -> Case:
        touches = random.integers(1, min(MAX_PIXELS_AT_ONCE, pixels), endpoint=True)
        cells = random.choice(pixels, touches, replace=False)
        rises = random.uniform(*factor, touches) - 1
        if not parts.fingers:
            return Case(None, cells, rises)
        ends = random.uniform(-AT_ENDS, 1 + AT_ENDS, touches)
        fingers = strongest * np.clip(ends, 0.0, 1.0)
        rises[random.random(touches) < AT_ENDS] = 0.0
        both = np.concatenate([cells, parts.finger(cells)])
        return Case(None, both, np.concatenate([rises, fingers]))

    return draw


def separated_draws(draw: Draw, skin: Skin, most: float) -> Draw:
    """Draws on separate pixels with skin, with rises from 0 to `most`.

    Rises are clipped to this range. If touches are on pixels that meet, only the first is left;
    touches on pixels without skin are left out.
    """
    on_skin, parts, columns = pixel_coverage(skin).part > 0, parts_of(skin), skin.pixels.columns

    def drawn(random: np.random.Generator) -> Case:
        case = draw(random)
        case = case.only(on_skin[parts.pixels(case.cells[None])[0][0]])
        foam, _ = parts.by_kind(case.cells, case.rises)
        row, column = np.divmod(foam.cells, columns)
        away = [
            not any(max(abs(row[k] - row[m]), abs(column[k] - column[m])) <= 1 for m in range(k))
            for k in range(len(foam.cells))
        ]
        pressed = foam.cells[np.array(away, dtype=bool)]
        left = case.only(np.isin(case.cells, [*pressed, *parts.finger(pressed)]))
        rises = np.where(left.cells < parts.foam, np.clip(left.rises, 0.0, most), left.rises)
        return replace(left, rises=rises)

    return drawn


def alone(pixels: Integer, rise: float, most: int) -> list[Case]:
    """Cases of one pixel each: all of these pixels, or `most` of them, evenly spaced."""
    some = np.unique(np.linspace(0, len(pixels) - 1, most).round().astype(np.int64))
    return [Case(None, pixels[[k]], np.array([rise])) for k in some]


def strongest_finger(skin: Skin, plan: Plan) -> float:
    """Capacitance of the strongest finger in the training, F.

    It is LARGEST_FINGER, or BEYOND_NAMED times the strongest finger of the scene if that is more.
    """
    drawn = plan.draws.press.finger
    pixels = (Touch(row, column, 1.0) for row, column in pixels_with_skin(skin))
    named = [
        0.0 if drawn is None else drawn.high,
        *(finger_of(p, None, plan.press.finger, skin) for p in pixels),
    ]
    return max(LARGEST_FINGER, BEYOND_NAMED * max(named))


def covering(draw: Draw, random: np.random.Generator, cells: int, idle: int) -> list[Case]:
    """Draws that touch every cell, most of them twice.

    Each draw but the first touches some cell that the earlier ones touch less than twice. Cells
    that draws hardly ever touch are left out: the search ends after `idle` useless draws in a row.
    """
    touched, kept, vain = np.zeros(cells, dtype=np.int64), list[Case](), 0
    while vain < idle and touched.min() < TWICE:
        case = draw(random)
        vain += 1
        pressed = case.cells[case.cells < cells]
        if not kept or touched[pressed].min(initial=TWICE) < TWICE:
            touched[pressed] += 1
            kept.append(case)
            vain = 0
    return kept


def sharing_skins(cases: list[Case], presses: int) -> list[Case]:
    """Same presses on fewer skins, because a skin costs more than a press.

    Each group of `presses` cases takes the skin of its first case.
    """
    return [
        replace(case, variation=cases[k - k % presses].variation) for k, case in enumerate(cases)
    ]


def by_skin(cases: Sequence[Case], skin: Skin) -> list[list[int]]:
    """Indices of the cases, grouped by skin. If presses change the sheets, a group is one case."""
    if gauged(skin):
        return [[k] for k in range(len(cases))]
    found: dict[int, list[int]] = {}
    for k, case in enumerate(cases):
        found.setdefault(id(case.variation), []).append(k)
    return list(found.values())
