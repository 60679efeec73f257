"""Measured sweeps as input of a fit: of the unpressed skin and of each press."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Complex, Integer, Mask, Real
from ..measure.readout import observed
from ..models.mechanics.force_depths import press_by_depths
from ..press.press import Press, check_press, parse_press, press_on, pressed_factor, strength_of
from ..press.touch import Touch, place_of
from ..scene.meter_tables import ReadoutErrors
from ..scene.parts import Pressing, SceneParts, Setup, Skin
from ..sweeps import InputError
from ..sweeps.errors import named
from ..sweeps.inputs import objects
from ..sweeps.press_text import displayed_press
from ..sweeps.reading_quantities import IMPEDANCE, MAGNITUDE, kind_of
from ..sweeps.reading_subset import read_mask, restricted, with_named_interface
from ..sweeps.schema import complex_readings, taken_of

if TYPE_CHECKING:
    import xarray as xr


UNKNOWN_RANGE = -1
"""Number of the fixed error of a reading that may belong to either of two ranges."""
NEAR_EDGE = 3.0
"""Distance of |Z| from the edge of a range, in its errors, within which the range is unknown."""
NAMED = 3
"""Number of presses that a reason to leave them out names."""


@dataclass(frozen=True)
class SessionSweep:
    """Sweep of one press in one session, or the mean of all baseline sweeps of a session.

    Z: ohm, or gain, shape (interface, frequency), 1 where nothing was read. fixed: number of the
    fixed error of the session that each reading has, same shape; UNKNOWN_RANGE where it is not
    known, and the reading is then not used. averaged: number of averaged sweeps. deviation: sample
    standard deviation of `observed` over these, shape (2 * Z.size,), None for a single one.
    """

    press: Press
    session: int
    Z: Complex
    fixed: Integer
    averaged: int = 1
    deviation: Real | None = None

    @property
    def known(self) -> Mask:
        """True where the fixed error of a reading is known, shape (interface, frequency)."""
        return self.fixed != UNKNOWN_RANGE


@dataclass(frozen=True)
class Measurements:
    """Measured sweeps of a scene.

    parts: of the scene, with the setup of the sweeps. left_out: one line for each
    reason why presses could not be used.
    """

    parts: SceneParts
    sweeps: tuple[SessionSweep, ...]
    left_out: tuple[str, ...] = ()

    @cached_property
    def read(self) -> Mask:
        """True where an interface was read at a frequency, shape (interface, frequency)."""
        return self.parts.setup.read

    @property
    def per_reading(self) -> int:
        """Numbers of a reading: magnitude and phase, or the magnitude alone."""
        return 1 if self.parts.setup.kind is MAGNITUDE else 2

    @cached_property
    def numbers(self) -> int:
        """Number of measured values of all readings that are used."""
        return self.per_reading * sum(
            int((self.read & reading.known).sum()) for reading in self.sweeps
        )

    @cached_property
    def fixed(self) -> int:
        """Number of the meter's fixed errors of one kind in a session."""
        return 1 + max(0, *(int(reading.fixed.max()) for reading in self.sweeps))

    @cached_property
    def first(self) -> tuple[Real, Complex]:
        """Frequencies in Hz and Z in ohm of the first sweep at the first interface."""
        return self.parts.setup.frequency[self.read[0]], self.sweeps[0].Z[0, self.read[0]]

    @cached_property
    def sessions(self) -> list[int]:
        """Numbers of the sessions that have sweeps."""
        return sorted({reading.session for reading in self.sweeps})


def measurements_of(
    parts: SceneParts,
    sweeps: xr.Dataset,
    band: tuple[float, float] | None = None,
    session: int | None = None,
) -> Measurements:
    """Sweeps of a scene: the mean baseline sweep of each session, and every press.

    band: lowest and highest frequency that is used, Hz; interfaces without a reading in it are left
    out. session: the only session that is used. A sweep whose interface has no name is that of a
    scene with one interface. Presses that are not whole pixels of the scene are left out. Raises
    InputError where the scene lacks an interface, or no sweep remains.
    """
    if session is not None:
        sweeps = _of_session(sweeps, session)
    if band is not None:
        sweeps = _within(sweeps, band)
    sweeps = restricted(sweeps, read_mask(sweeps))
    sweeps = with_named_interface(sweeps, parts.setup.names)
    bare = parts.read(_as_measured(parts.setup, parts.skin.name, sweeps))
    presses, left_out = _presses(bare.skin, bare.plan.press, list(sweeps["press"].values))
    sessions = [int(each) for each in sweeps["session"].values]
    Z = complex_readings(sweeps)
    known = np.where(bare.setup.read, Z, 1.0)
    settings = None if bare.setup.gain else sweeps.attrs.get("settings")
    fixed = _fixed(known, bare.setup.frequency, settings, parts.meter.readout)
    readings = tuple(_readings(known, fixed, presses, sessions))
    if not readings:
        raise InputError(f"no sweep can be used: {'; '.join(left_out) or 'the file has none'}")
    return Measurements(bare, readings, left_out)


def _of_session(sweeps: xr.Dataset, session: int) -> xr.Dataset:
    there = sorted({int(each) for each in sweeps["session"].values})
    if session not in there:
        known = ", ".join(map(str, there))
        raise InputError(f"{named('session')} must be one of {known}, got {session}")
    return sweeps.isel(sweep=sweeps["session"].values == session)


def _within(sweeps: xr.Dataset, band: tuple[float, float]) -> xr.Dataset:
    f = sweeps["frequency"].values
    inside = (f >= band[0]) & (f <= band[1])
    if not inside.any():
        raise InputError(
            f"{named('band')} must contain frequencies of the sweeps, {f[0]:g} to {f[-1]:g} Hz, "
            f"got {band[0]:g} to {band[1]:g} Hz"
        )
    return sweeps.isel(frequency=inside)


def _as_measured(setup: Setup, name: str, sweeps: xr.Dataset) -> Setup:
    """The setup at the interfaces and frequencies of the sweeps. name: of the scene."""
    names = [str(each) for each in sweeps["interface"].values]
    for each in names:
        if each not in setup.names:
            raise InputError(
                f"the sweeps were measured at interface {each!r}; "
                f"{name} has {', '.join(setup.names)}"
            )
    chosen = _read_as(setup, name, sweeps).of(names)
    return chosen.taking(sweeps["frequency"].values, taken_of(sweeps))


def _read_as(setup: Setup, name: str, sweeps: xr.Dataset) -> Setup:
    """The setup, with readers of magnitudes alone where the sweeps have no phases."""
    kind, own = kind_of(sweeps.variables), setup.kind
    if kind is own:
        return setup
    if IMPEDANCE in (kind, own):
        raise InputError(
            f"every reading of the sweeps is the {kind.name}; {name} reads the {own.name}: "
            'set `reader` of each [[interface]] to "gain" or "impedance"'
        )
    update = {"magnitude_only": kind is MAGNITUDE}
    return replace(
        setup, interfaces=tuple(each.model_copy(update=update) for each in setup.interfaces)
    )


def _presses(
    skin: Skin, pressing: Pressing, texts: Sequence[str]
) -> tuple[list[Press | None], tuple[str, ...]]:
    """Each press, None for those left out, and the reasons for leaving them out."""
    presses: list[Press | None] = []
    remarks: dict[str, None] = {}
    left_out: dict[str, dict[str, None]] = {}
    for text in map(str, texts):
        try:
            press, rods = _recorded(skin, pressing, text)
            press = press_by_depths(skin, press)
            for touch in press.touches:
                pressed_factor(skin, touch)
        except InputError as reason:
            presses.append(None)
            remarks[str(reason)] = None
            continue
        remarks |= dict.fromkeys(rods)
        reason = _not_fitted(skin, pressing, press)
        if reason:
            left_out.setdefault(reason, {})[displayed_press(text)] = None
        presses.append(None if reason else press)
    return presses, (*(f"{_named([*some])}: {why}" for why, some in left_out.items()), *remarks)


def _named(presses: Sequence[str]) -> str:
    """The presses by their texts; the first ones and their number for more than NAMED."""
    if len(presses) <= NAMED:
        return f"press {', '.join(presses)}"
    return f"{len(presses)} presses, {', '.join(presses[:NAMED])} ..."


def _recorded(skin: Skin, pressing: Pressing, text: str) -> tuple[Press, list[str]]:
    """The press, without its fingers where the scene has no earth, and a remark on that."""
    if skin.around is not None:
        return press_on(skin, pressing, text), []
    press = parse_press(text, strength_of(pressing), skin, pressing)
    rods = press.of(replace(touch, finger=0.0) for touch in press.touches)
    remark = f"fingers of presses, because {skin.name} has no [surroundings]"
    return check_press(rods, skin), [remark] if press.fingers else []


def _not_fitted(skin: Skin, pressing: Pressing, press: Press) -> str | None:
    """Why a press cannot be fitted to the scene."""
    if not all(isinstance(place_of(touch), Touch) for touch in press.touches):
        return "only whole pixels can be fitted"
    if bool(press.touches) and bool(press.indented) == pressing.by_factor:
        kind = "capacitance factors" if pressing.by_factor else "depths"
        return f"only {kind} can be fitted to {skin.name}"
    return None


def _fixed(Z: Complex, f: Real, settings: str | None, readout: ReadoutErrors) -> Integer:
    """Number of the fixed error of a session that each reading has, in the shape of Z.

    f: frequencies, Hz. settings: JSON of the meter that recorded the sweeps. A meter has one error
    in each of its ranges, the same at all interfaces; its automatic range is the lowest decade that
    holds |Z|. The range is unknown where |Z| is so near a decade that the error of the reading
    decides, unless all readings are that near. Without a meter (None) each interface has its own
    error, as `readout.read_out` draws them.
    """
    if settings is None:
        return np.broadcast_to(np.arange(Z.shape[1])[:, None], Z.shape)
    if not objects(settings).get("auto_range", True):
        return np.zeros(Z.shape, dtype=np.int64)
    size = np.log10(np.abs(Z))
    error = np.hypot(readout.accuracy(Z, f)[0], readout.noise(Z, f)[0]) / math.log(10)
    numbers = np.unique(np.ceil(size), return_inverse=True)[1].reshape(Z.shape)
    near = np.abs(size - np.round(size)) < NEAR_EDGE * error
    return np.where(near & ~near.all(), UNKNOWN_RANGE, numbers)


def _readings(
    Z: Complex, fixed: Integer, presses: Sequence[Press | None], sessions: Sequence[int]
) -> Iterator[SessionSweep]:
    unpressed: dict[int, list[int]] = {}
    for k, (press, session) in enumerate(zip(presses, sessions, strict=True)):
        if press is not None and not press.touches:
            unpressed.setdefault(session, []).append(k)
    for session, members in unpressed.items():
        yield _averaged(Z[members], fixed[members], session)
    for k, (press, session) in enumerate(zip(presses, sessions, strict=True)):
        if press is not None and press.touches:
            yield SessionSweep(press, session, Z[k], fixed[k])


def _averaged(Z: Complex, fixed: Integer, session: int) -> SessionSweep:
    """Mean baseline sweep, in ln |Z| and phase. Z, fixed: shape (sweep, interface, frequency)."""
    own = np.where((fixed == fixed[0]).all(axis=0), fixed[0], UNKNOWN_RANGE)
    mean = Z[0] * np.exp(np.log(Z / Z[0]).mean(axis=0))
    deviation = observed(Z / mean).std(axis=0, ddof=1) if len(Z) > 1 else None
    return SessionSweep(Press(), session, mean.astype(np.complex128), own, len(Z), deviation)
