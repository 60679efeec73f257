"""One point of a study: its experiment drawn several times, read out, and judged."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from ..measure.experiment import METER, PRESSES, planned_presses
from ..measure.readout import read_out
from ..measure.symmetry import Pixel
from ..press.press import Press, every_press, pressed_factor
from ..scene.scene import Scene
from ..sweeps import InputError, build
from .curve import Curve
from .separation import TARGETS, Label, Separation, in_units_of_error, label_of, separation

if TYPE_CHECKING:
    import xarray as xr

FOLDS = 5


class CrossValidate(Protocol):
    """The fraction of sweeps whose class is told right when they are not trained on."""

    def __call__(self, sweeps: xr.Dataset, *, target: str, folds: int, seed: int) -> float: ...


@dataclass(frozen=True)
class Trial:
    """How the experiment of every point is done.

    target: "column", "row" or "pixel". draws: how often presses and meter are drawn anew.
    """

    target: str = "column"
    draws: int = 3

    def check(self, scene: Scene) -> None:
        """Raises InputError where a scene's experiment cannot be judged."""
        if self.target not in TARGETS:
            raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {self.target!r}")
        if not 1 <= self.draws <= 1000:
            raise InputError(f"`draws` must be from 1 to 1000, got {self.draws}")
        in_units_of_error(np.ones((1, 1, 1), dtype=complex), scene.readout)
        sizes = defaultdict(int)
        for press in self.planned(scene, 0):
            sizes[label_of(press.pixel, self.target)] += 1
        if len(sizes) < 2:
            raise InputError(f"need at least 2 classes of `target` {self.target}, got {len(sizes)}")
        if min(sizes.values()) < FOLDS:
            raise InputError(
                f"`experiment.repetitions` must give at least {FOLDS} presses of each class of "
                f"`target` {self.target}, got {min(sizes.values())}"
            )

    def planned(self, scene: Scene, draw: int) -> list[Press]:
        """The presses of one draw. Raises InputError where a factor of 0 or less could be drawn."""
        random = np.random.default_rng([scene.experiment.seed, PRESSES, draw])
        return planned_presses(scene, random)

    def nominal(self, scene: Scene) -> list[Press]:
        """One press of the nominal strength for each pixel on the skin; rest if that is a class."""
        return every_press(scene)[0 if scene.experiment.unpressed else 1 :]

    def factors(self, scene: Scene) -> dict[Pixel, set[float]]:
        """Every strength at which each pixel is pressed."""
        found: dict[Pixel, set[float]] = defaultdict(set)
        draws = (self.planned(scene, draw) for draw in range(self.draws))
        for press in [*self.nominal(scene), *(press for draw in draws for press in draw)]:
            found[press.pixel].add(strength(scene, press))
        return found


@dataclass(frozen=True)
class Findings:
    """What was found at a point: the fraction told right at each draw, and the separation."""

    accuracies: tuple[float, ...]
    separation: Separation


def strength(scene: Scene, press: Press) -> float:
    """The capacitance factor under a press of one pixel; 1 at rest."""
    return pressed_factor(scene, press.touches[0]) if press.touches else 1.0


def judge(
    scene: Scene, trial: Trial, curves: Mapping[Pixel, Curve], cross_validate: CrossValidate
) -> Findings:
    """Draw, read out and cross-validate a scene's experiment, and separate its nominal presses.

    curves: Z of every pixel at the scene's frequencies.
    """
    nominal = trial.nominal(scene)
    labels: list[Label] = [label_of(press.pixel, trial.target) for press in nominal]
    Z = impedances(scene, nominal, curves)
    readings = in_units_of_error(Z, scene.readout, scene.taken)
    return Findings(
        tuple(
            cross_validate(
                _measured(scene, trial, draw, curves), target=trial.target, folds=FOLDS, seed=draw
            )
            for draw in range(trial.draws)
        ),
        separation(readings, labels, scene.frequencies),
    )


def impedances(
    scene: Scene, presses: Sequence[Press], curves: Mapping[Pixel, Curve]
) -> NDArray[np.complex128]:
    """Z in ohm, shape (press, interface, frequency)."""
    places: dict[Pixel, list[int]] = defaultdict(list)
    for index, press in enumerate(presses):
        places[press.pixel].append(index)
    first = next(iter(curves.values()))
    Z = np.empty((len(presses), *first.logarithm.shape[1:]), dtype=complex)
    for pixel, indices in places.items():
        Z[indices] = curves[pixel].impedance([strength(scene, presses[index]) for index in indices])
    return Z


def _measured(scene: Scene, trial: Trial, draw: int, curves: Mapping[Pixel, Curve]) -> xr.Dataset:
    presses = trial.planned(scene, draw)
    rows, columns = zip(*(press.pixel for press in presses), strict=True)
    exact = build(
        impedances(scene, presses, curves),
        scene.frequencies,
        interface=[interface.name for interface in scene.interfaces],
        press=[str(press) for press in presses],
        row=rows,
        column=columns,
        taken=scene.taken,
    )
    return read_out(
        exact, scene.readout, np.random.default_rng([scene.experiment.seed, METER, draw])
    )
