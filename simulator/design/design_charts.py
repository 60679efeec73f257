"""Charts of a design: the gain of each step, the sensitivity of the optimum, the wiring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..chart_style import COLOURS, UNPRESSED_COLOUR, chart, foil_offset
from ..mesh.from_above import MM, draw_outline, ribbon
from ..scene.contacts import Interface
from ..scene.design_goals import POSITION, Design
from ..scene.parts import SceneParts, Skin
from .goals import TouchPositions
from .search import SearchStep
from .sensitivity import SensitivityCurve

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class MeritScale:
    """Conversion of merits. guess: distance in m at merit 0, None for shares of sweeps."""

    target: str
    guess: float | None = None

    @property
    def point(self) -> float:
        """Smallest relevant difference of merit: a percentage point, or a tenth of a mm."""
        return 0.01 if self.guess is None else 1e-4 / self.guess

    @property
    def named(self) -> str:
        """That difference in words."""
        return "one percentage point" if self.guess is None else "a tenth of a millimetre"

    @property
    def unit(self) -> str:
        """Unit of the reported numbers."""
        return "%" if self.guess is None else "mm"

    @property
    def of(self) -> str:
        """Meaning of the reported numbers."""
        if self.guess is None:
            return f"largest share of correct {self.target}s"
        return "smallest median error of positions"

    def number(self, merit: float) -> float:
        """A merit in that unit."""
        return 100 * merit if self.guess is None else 1e3 * self.guess * (1 - merit)

    def change(self, merit: float) -> float:
        """A difference of merits in that unit; more merit is fewer mm."""
        return 100 * merit if self.guess is None else -1e3 * self.guess * merit

    def text(self, merit: float) -> str:
        """A merit as text, without its unit."""
        return f"{self.number(merit):.{1 if self.guess is None else 2}f}"

    def wanted(self, request: Design) -> float | None:
        """The required merit, None where there is none."""
        if self.guess is None:
            return request.want
        return None if request.within is None else 1 - request.within / self.guess


def scale_of(parts: SceneParts, request: Design) -> MeritScale:
    """Scale of merits for a design of a scene."""
    if request.target != POSITION:
        return MeritScale(request.target)
    return MeritScale(request.target, TouchPositions(parts).merit.guess)


IN_A_ROW = 5
ALL = 100.0
"""Percent."""
LETTER_OFF = 0.11
"""Distance of letters from the edge, over the skin's longer side."""
LETTER_AT = {"top": 0.35, "bottom": 0.65}
"""Position of the letter of each sheet along its foil: both foils may be on one edge."""
WIDE, TITLE = 2.4, 0.5
"""Inches: width of each skin with its margin, and height of its title."""
AROUND_SKIN = 0.18
"""Margin around a skin, over its longer side."""


def draw_steps(
    steps: Sequence[SearchStep], wanted: float | None, scale: MeritScale, to: Path
) -> None:
    """Draws the bound after each step: for nine of ten samples, and for the nominal skin."""
    with chart(to, 7, 0.6 + 0.45 * len(steps)) as figure:
        axes = figure.subplots()
        places = range(len(steps))
        shades = [COLOURS[0] if step.taken else "0.75" for step in steps]
        axes.barh(list(places), [scale.number(step.tenth) for step in steps], color=shades)
        axes.plot(
            [scale.number(step.nominal) for step in steps],
            list(places),
            "o",
            color=COLOURS[1],
            label="nominal skin",
        )
        if wanted is not None:
            axes.axvline(
                scale.number(wanted), color=UNPRESSED_COLOUR, linestyle="--", label="required"
            )
        axes.set_yticks(list(places), [step.name for step in steps])
        axes.invert_yaxis()
        axes.set_xlabel(f"{scale.of}, nine of ten samples ({scale.unit}); grey: not taken")
        axes.set_axisbelow(True)
        figure.legend(loc="outside upper right", ncols=2)


def draw_flat(found: Sequence[SensitivityCurve], scale: MeritScale, to: Path) -> None:
    """Draws the bound where numbers differ from the design by a factor."""
    with chart(to, 6, 3.4) as figure:
        axes = figure.subplots()
        for each, colour in zip(found, COLOURS, strict=False):
            shares = [scale.number(merit) for merit in each.tenths]
            axes.plot(each.factors, shares, "o-", color=colour, label=each.name)
        axes.set_xscale("log")
        axes.set_xticks(found[0].factors, [f"{factor:g}" for factor in found[0].factors])
        axes.minorticks_off()
        axes.set_xlabel("actual over designed value")
        axes.set_ylabel(f"{scale.of},\nnine of ten samples ({scale.unit})")
        if scale.unit == "%":
            low, high = axes.get_ylim()
            axes.set_yticks([y for y in axes.get_yticks() if low <= y <= min(high, ALL)])
            axes.set_ylim(low, high)
        axes.legend()


def draw_wiring(skin: Skin, readings: Sequence[Interface], to: Path) -> None:
    """Draws the foils of a skin at each reading: H, L, or open (grey).

    Foils of the bottom sheet are dashed, and outside those of the top sheet.
    """
    rows = -(-len(readings) // IN_A_ROW)
    columns = min(len(readings), IN_A_ROW)
    length, width = (side + 2 * AROUND_SKIN * max(skin.sides) for side in skin.sides)
    with chart(to, WIDE * columns, (WIDE * width / length + TITLE) * rows) as figure:
        grid = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes in grid[len(readings) :]:
            axes.set_axis_off()
        for axes, reading in zip(grid, readings, strict=False):
            _draw_reading(axes, skin, reading)


def _draw_reading(axes: Axes, skin: Skin, reading: Interface) -> None:
    longer = max(skin.sides)
    draw_outline(axes, skin, color="0.6")
    for contact in skin.contacts:
        side = "H" if contact.name in reading.high else "L" if contact.name in reading.low else ""
        colour = {"H": COLOURS[1], "L": COLOURS[0], "": "0.75"}[side]
        foil, style = ribbon(contact, skin), "-" if contact.electrode == "top" else (0, (2, 1))
        line = MM * foil.beside(foil_offset(contact.electrode, longer))
        axes.plot(*line, color=colour, linewidth=2.5, linestyle=style, solid_capstyle="butt")
        at = int(LETTER_AT[contact.electrode] * line.shape[1])
        where = MM * foil.beside(LETTER_OFF * longer)[:, at]
        axes.annotate(side, (where[0], where[1]), color=colour, ha="center", va="center")
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
    room = AROUND_SKIN * longer
    axes.set_xlim(-MM * room, MM * (skin.length + room))
    axes.set_ylim(-MM * room, MM * (skin.width + room))
    axes.set_title(reading.name.replace(" to ", "\nto "), fontsize=8)
