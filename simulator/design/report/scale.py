"""How merits, which are 1 at most, are told to people: shares in %, distances in mm."""

from __future__ import annotations

from dataclasses import dataclass

from ...scene.design_goals import POSITION, Design
from ...scene.scene import Scene
from ..places import Touches


@dataclass(frozen=True)
class Scale:
    """target: of the design. guess: distance in m at merit 0, None for shares of sweeps."""

    target: str
    guess: float | None = None

    @property
    def point(self) -> float:
        """The least merit that people care about: a point, or a tenth of a millimetre."""
        return 0.01 if self.guess is None else 1e-4 / self.guess

    @property
    def named(self) -> str:
        """That merit in words."""
        return "a point" if self.guess is None else "a tenth of a millimetre"

    @property
    def unit(self) -> str:
        """Of numbers."""
        return "%" if self.guess is None else "mm"

    @property
    def of(self) -> str:
        """What numbers are of."""
        return "right at most" if self.guess is None else "half of all answers no nearer than"

    def number(self, merit: float) -> float:
        """In that unit."""
        return 100 * merit if self.guess is None else 1e3 * self.guess * (1 - merit)

    def change(self, merit: float) -> float:
        """Of a difference of merits; less mm for more merit."""
        return 100 * merit if self.guess is None else -1e3 * self.guess * merit

    def text(self, merit: float) -> str:
        """Without its unit."""
        return f"{self.number(merit):.{1 if self.guess is None else 2}f}"

    def wanted(self, asked: Design) -> float | None:
        """The merit that is asked for, if any is."""
        if self.guess is None:
            return asked.want
        return None if asked.within is None else 1 - asked.within / self.guess


def scale_of(scene: Scene, asked: Design) -> Scale:
    """Of a design of a scene."""
    if asked.target != POSITION:
        return Scale(asked.target)
    return Scale(asked.target, Touches(scene).near.guess)
