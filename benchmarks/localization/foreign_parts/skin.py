"""A twin that rcskin's model did not make: a skin of the three-dimensional solve under a hand.

Sheets and foam are non-uniform, leads and meter are drawn, and the skin drifts, as in
`twin_parts.skin`. The surroundings are those of an effect.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.three_dimensions_parts.blocks import block_of
from rcskin.benchmarks.accuracy.three_dimensions_parts.layers import body
from rcskin.benchmarks.accuracy.three_dimensions_parts.lines import Grid
from rcskin.benchmarks.accuracy.three_dimensions_parts.skin import ForeignSkin
from rcskin.benchmarks.accuracy.three_dimensions_parts.solved import Solved
from rcskin.benchmarks.accuracy.three_dimensions_parts.statics import Static
from rcskin.benchmarks.accuracy.three_dimensions_parts.touching import Patch
from rcskin.benchmarks.localization.foreign_parts.effects import BODY, Effect
from rcskin.benchmarks.localization.twin_parts.skin import Bench, Twin
from rcskin.simulator.measure.skins import DrawnSkin, drawn_skin
from rcskin.simulator.models.parameters import HALF_WAVES, mode_values
from rcskin.simulator.press.pixels import cell_centres
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.scene import Scene

THICKNESS = 4e-3
"""Thickness of the paper's foam, m."""
FINGER = 103
"""Kind of random numbers, in addition to those of `twin_parts.skin`."""
SHARE, TIME = 0.1, 1.0
"""Share of the rise of c that comes by creep, and its time constant, s."""
SAME_FREQUENCY = 1e-3
"""Largest relative difference between a frequency of the scene and that of the meter."""
GRID = (12, 12)
"""Cells of the foam that its cosine modes are fitted to."""


def solved(scene: Scene, folder: Path, grid: Grid) -> dict[bool, Solved]:
    """Static solves of a scene's skin without a body and with one, kept in a folder."""
    files = {there: folder / f"{'body' if there else 'air'}.npz" for there in (False, True)}
    if not all(file.exists() for file in files.values()):
        static = Static(block_of(scene, thickness=THICKNESS, grid=grid))
        static.solved().save(files[False])
        static.solved(below=body(BODY)).save(files[True])
    return {there: Solved.load(file) for there, file in files.items()}


@dataclass(frozen=True)
class Foreign(Twin):
    """A twin with an effect. around: static solve of its scene's skin."""

    effect: Effect = Effect("")
    around: Solved | None = None

    @cached_property
    def drawn(self) -> DrawnSkin:
        """The skin and its leads at the first press."""
        parts = self.scene.parts.on_grid(*GRID)
        return drawn_skin(parts, self.seed, self.number, GRID, len(HALF_WAVES))

    @cached_property
    def foreign(self) -> ForeignSkin:
        """The skin at the first press."""
        assert self.around is not None
        own = self.drawn.variation
        centres = mode_values(
            self.scene.parts.skin, cell_centres(self.scene.parts.skin, GRID), len(HALF_WAVES)
        )
        foam, *_ = np.linalg.lstsq(
            centres.reshape(len(HALF_WAVES), -1).T, own.capacitance.ravel(), rcond=None
        )

        def along(waves: NDArray[np.float64], x: NDArray, y: NDArray) -> NDArray[np.float64]:
            return waves @ mode_values(self.scene.parts.skin, np.stack([x, y]), len(HALF_WAVES))

        return ForeignSkin(
            self.scene,
            self.around,
            top=lambda x, y: 1 / along(own.top, x, y),
            bottom=lambda x, y: 1 / along(own.bottom, x, y),
            foam=lambda x, y: along(foam, x, y),
            edges=self.effect.edges,
        )

    def at(self, interface: str) -> ForeignBench:
        """The twin with a meter at one interface. Raises InputError where there is none."""
        return ForeignBench(self, interface)

    def impedances(self, asked: Press, event: int) -> NDArray[np.complex128]:
        """Z in ohm behind the leads, shape (interface, frequency), at the hand's event-th press.

        With both sheets r times as resistive and all capacitance c times as large, Z at s is r
        times that at r c s.
        """
        known = self._solved.get((asked, event))
        if known is not None:
            return known
        f, (c, r) = self.scene.frequencies, self.drifted(event)
        s = laplace_variable(f, self.drawn.variation.loss)
        hand = self.pressed(asked, event).touches
        patches = [self._patch(touch, event) for touch in hand if isinstance(touch, Rectangle)]
        Z = r * self.foreign.impedance(patches, r * c * s)
        return self._solved.setdefault((asked, event), self.drawn.leads.at_meter(Z, f))

    @cached_property
    def _solved(self) -> dict[tuple[Press, int], NDArray[np.complex128]]:
        """Impedances by press and event: benches at other interfaces read the same presses."""
        return {}

    def _patch(self, touch: Rectangle, event: int) -> Patch:
        random, (least, most) = self._random(FINGER, event), self.effect.finger
        box, finger = touch.box, float(random.uniform(least, most))
        return Patch(*box, factor=1 + (touch.factor - 1) * self._given_way, finger=finger)

    @property
    def _given_way(self) -> NDArray[np.float64] | float:
        """Share of the rise of c, by frequency: frequencies are read one after the other."""
        if not self.effect.creep:
            return 1.0
        count = len(self.scene.frequencies)
        time = self.effect.creep * (np.arange(count) + 1) / count
        return 1 - SHARE * np.exp(-time / TIME)


class ForeignBench(Bench):
    """A foreign twin at one of its interfaces: every press is solved once at all frequencies."""

    def __init__(self, twin: Foreign, interface: str) -> None:
        name = twin.scene.parts.setup.checked_name(interface)
        self._twin, self._number = twin, twin.scene.parts.setup.names.index(name)
        self._event, self._press = 0, Press(())
        self._checked, self._Z = False, None

    def check(self, press: str) -> str:
        """What the hand makes of a press. Raises InputError where it does not fit the scene."""
        scene = self._twin.scene
        asked = check_press(parse_press(press, scene.press.capacitance_factor), scene.parts.skin)
        self._event += self._checked
        self._press, self._checked, self._Z = asked, True, None
        return str(self._twin.pressed(asked, self._event))

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under the latest checked press, at one of the scene's frequencies in Hz."""
        if self._Z is None:
            self._Z = self._twin.impedances(self._press, self._event)[self._number]
        f = self._twin.scene.frequencies
        nearest = int(np.abs(f - frequency).argmin())
        assert abs(f[nearest] / frequency - 1) < SAME_FREQUENCY, frequency
        return complex(self._Z[nearest])
