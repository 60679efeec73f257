"""Shares of a multisine's power among its tones that minimize a criterion of `criteria`.

The noise of a tone is inverse to its amplitude, so that its information is proportional to its
power. With the crest factor constant, the sum of the powers is fixed by the peak voltage: shares
are a choice of many small parts of the power with repetition. The feedback resistance follows from
the peak of the amplifier's output, so that tones of large currents cost the others resolution.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Complex, Integer, Real
from ..bounds.exchange import best_choice
from ..bounds.fields import TouchSize
from ..models.solver import Solver
from ..press.press import Press
from ..progress import ProgressCallback, silent
from ..scene.multisine.excitation import amplitudes, crest_factor, output_peak
from ..scene.multisine.noise import multisine_deviation, output_density
from ..scene.multisine.reader import Multisine
from ..scene.scene import Scene
from ..sweeps import InputError
from .criteria import Criterion
from .frequency_design import criterion_at

PARTS = 10
"""Number of parts of the mean power of a tone. Every tone keeps at least one of them."""
FILLED = 0.7
"""Peak of the output for the unpressed skin over the ADC's range; presses raise the current."""
DIGITS = 3
STEPS = 20
MAX_RESISTANCE = 1e9
"""Largest feedback resistance, ohm; beyond it a feedback capacitance has all the current."""


@dataclass(frozen=True)
class AmplitudeShares:
    """Equal and shared amplitudes of a scene's tones, each with its own feedback resistance.

    figures: of the criterion, minimized, for the equal and for the shared ones, over what equal
    ones resolve. In m for position, for column and pixel 1 over the distance in the reader's
    errors. unpressed: reading of the
    unpressed skin, ohm, shape (interface, frequency).
    """

    criterion: str
    equal: Scene
    shared: Scene
    figures: tuple[float, float]
    unpressed: Complex

    @property
    def amplitudes(self) -> Real:
        """Shared amplitudes over the equal ones, by the voltages of the source."""
        equal, shared = (
            np.abs(amplitudes(_reader(each), each.frequencies))
            for each in (self.equal, self.shared)
        )
        return shared / equal

    @property
    def deviations(self) -> tuple[Real, Real]:
        """Deviations of ln |Z| at the noisiest interface, equal and shared, (frequency,)."""
        equal, shared = (
            multisine_deviation(_reader(each), self.unpressed, each.frequencies).max(axis=0)
            for each in (self.equal, self.shared)
        )
        return equal, shared

    @property
    def summary(self) -> list[str]:
        """Lines on both: figure of the criterion, feedback resistance and crest factor."""
        return [
            f"{name}: {self._figure(figure)}, feedback resistance "
            f"{_reader(scene).feedback_resistance:g} ohm, crest factor "
            f"{crest_factor(_reader(scene), scene.frequencies):.3g}"
            for name, scene, figure in zip(
                ("equal", "shared"), (self.equal, self.shared), self.figures, strict=True
            )
        ]

    def _figure(self, figure: float) -> str:
        if self.criterion == "position":
            return f"rms bound {1e3 * figure:.4g} mm"
        return f"nearest {self.criterion}s {1 / figure:.3g} errors apart"


def shared_amplitudes(
    scene: Scene,
    touch: TouchSize,
    *,
    criterion: str = "position",
    against_rest: int = 0,
    progress: ProgressCallback = silent,
) -> AmplitudeShares:
    """Amplitudes of a scene's tones that minimize a criterion, compared with equal ones.

    Raises InputError for a scene without a multisine reader, and as `criterion_at` does.
    """
    _reader(scene)
    unpressed = Solver(scene).solve(Press()).Z
    equal = fitted(scene.with_({"readout.multisine.amplitudes": None}), unpressed)
    at_equal = criterion_at(equal, criterion, equal.frequencies, touch, against_rest, progress)[0]
    information = ToneInformation(_reader(equal), unpressed, equal.frequencies)
    powers = _best_powers(at_equal, information)
    shares = [float(f"{each:.{DIGITS}g}") for each in np.sqrt(powers)]
    shared = fitted(scene.with_({"readout.multisine.amplitudes": shares}), unpressed)
    figures = at_equal.of_all, float(at_equal.weighted(information.exactly(_reader(shared)))[0])
    if figures[1] > figures[0]:
        shared, figures = equal, (figures[0], figures[0])
    return AmplitudeShares(criterion, equal, shared, figures, unpressed)


def fitted(scene: Scene, unpressed: Complex) -> Scene:
    """The scene with the feedback resistance whose output peaks at FILLED of the ADC's range.

    unpressed: reading of the unpressed skin, ohm, shape (interface, frequency).
    """
    reader = _reader(scene)
    for _ in range(STEPS):
        peak = float(output_peak(reader, unpressed, scene.frequencies).max())
        ratio = FILLED * reader.full_scale / peak
        R = min(max(reader.feedback_resistance * ratio, 1.0), MAX_RESISTANCE)
        reader = reader.model_copy(update={"feedback_resistance": R})
    rounded = float(f"{reader.feedback_resistance:.{DIGITS}g}")
    return scene.with_({"readout.multisine.feedback_resistance": rounded})


@dataclass(frozen=True)
class ToneInformation:
    """Information of each tone over that at equal powers, with the resistance fitted anew.

    The crest factors of source and output are taken as those at equal powers. reader: of equal
    powers. unpressed: see `AmplitudeShares`. frequency: Hz.
    """

    reader: Multisine
    unpressed: Complex
    frequency: Real

    def of(self, powers: Real) -> Real:
        """Information at powers of mean 1; both of shape (choice, tone)."""
        return np.stack([own * self._electronics(own) for own in powers])

    def exactly(self, reader: Multisine) -> Real:
        """Information with another reader's amplitudes and resistance, (1, tone).

        It is the mean over interfaces, whose ratios differ little.
        """
        before, after = (
            multisine_deviation(each, self.unpressed, self.frequency)
            for each in (self.reader, reader)
        )
        return ((before / after) ** 2).mean(axis=0, keepdims=True)

    def _electronics(self, powers: Real) -> Real:
        """Factor by the fitted resistance, mean over interfaces, shape (tone,)."""
        before, part = self._precision(self.reader), self._output_power
        ratio = np.sqrt(part.sum(axis=1).max() / (part @ powers).max())
        R = self.reader.feedback_resistance * ratio
        after = self._precision(self.reader.model_copy(update={"feedback_resistance": R}))
        return (after / before).mean(axis=0)

    def _precision(self, reader: Multisine) -> Real:
        """|Z_f|² over the density of the noise, shape (interface, tone)."""
        density = output_density(reader, self.unpressed, self.frequency)
        return np.abs(reader.feedback(self.frequency)) ** 2 / density

    @cached_property
    def _output_power(self) -> Real:
        """Part of each tone in the power of the output, at equal powers, (interface, tone)."""
        return np.abs(self.reader.feedback(self.frequency) / self.unpressed) ** 2


def _best_powers(criterion: Criterion, information: ToneInformation) -> Real:
    """Best powers of the tones, of mean 1. criterion: evaluated at equal powers."""
    tones = len(criterion.frequency)

    def powers(choices: Integer) -> Real:
        counts = np.stack([np.bincount(each, minlength=tones) for each in choices])
        return (1 + counts) * tones / (tones + choices.shape[1])

    chosen = best_choice(
        lambda choices: criterion.weighted(information.of(powers(choices))),
        tones,
        (PARTS - 1) * tones,
        excludes=np.zeros((tones, tones), dtype=bool),
    )
    return powers(chosen[None])[0]


def _reader(scene: Scene) -> Multisine:
    reader = scene.readout.multisine
    if reader is None:
        raise InputError(
            f'{scene.name}: `reader` must be "multisine" for amplitudes of tones, got '
            f'"{scene.interfaces[0].reader}"'
        )
    return reader
