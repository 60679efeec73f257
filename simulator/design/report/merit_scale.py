"""Units in which merits are reported: shares in %, distances in mm."""

from __future__ import annotations

from dataclasses import dataclass

from ...scene.design_goals import POSITION, Design
from ...scene.parts import SceneParts
from ..merits.touch_positions import TouchPositions


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
