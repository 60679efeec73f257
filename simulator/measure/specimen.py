"""A simulated skin for a virtual meter: pressed and measured one frequency at a time."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Self

import numpy as np

from ..arrays import Complex
from ..method_cache import cached_method
from ..models.mechanics.force_depths import depths_in_words
from ..models.solver import Solver
from ..press.pixels import pixels_with_skin
from ..press.press import Press, label_of, press_on
from ..press.touch import Touch
from ..scene.parts import Meter, SceneParts
from ..sweeps import InputError
from .foam_state import FoamState
from .readout import MeterSession

READINGS_KEPT = 4096
SWEEPS_KEPT = 256


class SolvedScene:
    """Cached solutions of a scene, at every interface."""

    def __init__(self, parts: SceneParts) -> None:
        self._frequencies, self._solver = parts.setup.frequency, Solver(parts)

    @cached_method(READINGS_KEPT)
    def impedances(self, press: Press, frequency: float) -> Complex:
        """Z in ohm, shape (interface,), at a frequency in Hz. Raises what `Solver.solve` raises."""
        own = np.flatnonzero(self._frequencies == frequency)
        if press.indented and own.size and not self._solver.parts.skin.foam.in_time:
            return self._sweeps(press)[:, own[0]]
        return self._solver.solve(press, frequency).Z[:, 0]

    @cached_method(SWEEPS_KEPT)
    def _sweeps(self, press: Press) -> Complex:
        """Solutions at all frequencies of the scene: mechanics is solved once for them."""
        return self._solver.solve(press).Z


@dataclass
class PressedFoam:
    """State of the pressed foam, in time by the reader's clock."""

    state: FoamState


class Specimen:
    """A scene at one of its interfaces, with a press that all interfaces share."""

    def __init__(self, parts: SceneParts, interface: str) -> None:
        self.skin, self.setup, self.pressing = parts.skin, parts.setup, parts.plan.press
        self._number = parts.setup.names.index(interface)
        self._solved, self._pixels = SolvedScene(parts), set(pixels_with_skin(parts.skin))
        self._foam = PressedFoam(FoamState(parts.skin))

    def at(self, interface: str) -> Self:
        """Same specimen at another interface; both share their solutions."""
        other = copy(self)
        other._number = self.setup.names.index(interface)
        return other

    def check(self, press: str) -> str:
        """Press in its full form. Raises InputError if it does not fit the scene, or a pixel has no
        skin."""
        return label_of(self._checked(press), self.skin, self.pressing)

    def hold(self, press: str, now: float) -> str:
        """Press the skin until the next press; returns the press in its full form.

        now: s by any clock. Raises what `check` and `FoamState.then` raise.
        """
        found, foam = self._checked(press), self._foam
        foam.state = foam.state.then(found, now - foam.state.since)
        return label_of(found, self.skin, self.pressing)

    def momentary(self, press: str, at: float) -> Press:
        """Equivalent press at a time, s by the clock of `hold`, with creep.

        press: text, for skins without a press of their own.
        """
        state = self._foam.state
        return state.after(max(0.0, at - state.since))

    def impedance(self, press: str | Press, frequency: float) -> complex:
        """Z in ohm at a frequency in Hz. Raises what `press_on` and `Solver.solve` raise."""
        found = press_on(self.skin, self.pressing, press) if isinstance(press, str) else press
        return complex(self._solved.impedances(found, frequency)[self._number])

    def depths(self, press: str) -> str:
        """Depths under the forces of a press, in words; empty without forces."""
        return "; ".join(depths_in_words(self.skin, [press_on(self.skin, self.pressing, press)]))

    def _checked(self, press: str) -> Press:
        found = press_on(self.skin, self.pressing, press)
        for touch in found.touches:
            if isinstance(touch, Touch) and (touch.row, touch.column) not in self._pixels:
                raise InputError(f"press {touch}: there is no skin at that place")
        return found


class MeterSessionErrors:
    """Errors of a meter in one session, with a fixed part for each range."""

    def __init__(self, meter: Meter, seed: int) -> None:
        self._readout, self._random = meter.readout, np.random.default_rng(seed)
        self._meters: dict[int, MeterSession] = {}

    def read(self, Z: complex, frequency: float, range_number: int) -> complex:
        """Z in ohm of one measurement at a frequency in Hz."""
        if range_number not in self._meters:
            self._meters[range_number] = MeterSession(self._readout, 1, self._random)
        meter, at = self._meters[range_number], np.array([frequency])
        return complex(meter.measure(np.array([[[Z]]]), at).item())
