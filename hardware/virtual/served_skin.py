"""Skins that a virtual meter serves, simulated or recorded, and the meters by their models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.meters.accuracy_table import (
    DERIVED_TABLE,
    VIRTUAL_MODEL,
    outside_band,
    reaching,
    read_table,
)
from ...simulator.sweeps import UNPRESSED, InputError
from ...simulator.sweeps.reading_quantities import IMPEDANCE
from .hioki import VirtualHioki
from .instrument import Instrument
from .keysight_analyser import VirtualE4990A
from .keysight_lcr import Virtual4284A, VirtualE4980A, VirtualE4980AL
from .measurement import MeasurementSetup, Readout
from .recorded_skin import RecordedSkin, exact_readout

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.scene.parts import SceneParts
    from ..reader.line_format import LineFormat
    from .measurement import Skin
    from .virtual_reader import VirtualReader


VIRTUAL_MODELS: dict[str, Callable[..., Instrument]] = {
    "IM3523": VirtualHioki,
    "E4980A": VirtualE4980A,
    "E4980AL": VirtualE4980AL,
    "4284A": Virtual4284A,
    "E4990A": VirtualE4990A,
}
"""Class of each model."""


def virtual_model(name: str) -> Callable[..., Instrument]:
    """Class of a model by its name, in any case. Raises InputError for another one."""
    try:
        return VIRTUAL_MODELS[name.upper()]
    except KeyError:
        known = ", ".join(VIRTUAL_MODELS)
        raise InputError(f"`model` must be one of {known}, got {name!r}") from None


ROUNDING = 1e-9


@dataclass(frozen=True)
class ServedSkin:
    """A served skin at its interfaces, the first of which is connected, and the meter's readout.

    rows, columns: of pixels. frequency: Hz, of the first reading, which compiles and fills caches.
    parts: with the measured readings, if the skin is simulated.
    """

    skins: Mapping[str, Skin]
    readout: Readout
    rows: int
    columns: int
    frequency: float
    parts: SceneParts | None = None

    @property
    def skin(self) -> Skin:
        """The skin at its first interface, which is connected at the start."""
        return next(iter(self.skins.values()))

    @property
    def pixels(self) -> list[str]:
        """All pixels that can be pressed."""
        every = product(range(1, self.rows + 1), range(1, self.columns + 1))
        return [f"{row},{column}" for row, column in every if self._takes(f"{row},{column}")]

    def _takes(self, press: str) -> bool:
        try:
            self.skin.check(press)
        except InputError:
            return False
        return True


def simulated(
    parts: SceneParts, interfaces: Sequence[str] | None = None, seed: int = 1
) -> ServedSkin:
    """Simulated skin of a scene at these or all interfaces, with the errors of a session.

    Raises InputError for other interfaces.
    """
    from ...simulator.measure.specimen import MeterSessionErrors, Specimen

    names = parts.setup.checked_names(interfaces)
    setup = parts.setup.of(names)
    whole, errors = Specimen(parts, names[0]), MeterSessionErrors(parts.meter, seed)
    return ServedSkin(
        {name: whole.at(name) for name in names},
        lambda Z, conditions: errors.read(Z, conditions.frequency, conditions.range),
        *parts.skin.pixels.shape,
        float(setup.frequency[0]),
        parts.read(setup),
    )


def recorded(sweeps: xr.Dataset, interfaces: Sequence[str] | None) -> ServedSkin:
    """Recorded skin at these or all interfaces. Raises InputError for others."""
    rows, columns = (max(1, int(sweeps[name].max())) for name in ("row", "column"))
    first = float(sweeps["frequency"][0])
    names = interfaces or [str(name) for name in sweeps["interface"].values]
    skins = {name: RecordedSkin(sweeps, name) for name in names}
    return ServedSkin(skins, exact_readout, rows, columns, first)


def instrument(
    served: ServedSkin,
    pace: float = 1.0,
    accuracy: Path = DERIVED_TABLE,
    model: str = VIRTUAL_MODEL,
) -> Instrument:
    """Virtual meter of an unpressed skin, with filled caches: all readings take the same time.

    pace: factor on measuring times; 1: as a real meter, 0: none. model: that it imitates. Raises
    InputError for another pace or model, or if the model lacks a frequency of the served scene.
    """
    _check_pace(pace)
    if served.parts is not None and served.parts.setup.gain:
        raise InputError(
            f"{served.parts.skin.name}: reads gains, and a meter reads impedances; serve it by "
            "--reader"
        )
    meter = virtual_model(model)(
        MeasurementSetup(served.skin, served.readout, read_table(accuracy)),
        pace=pace,
        press=served.skin.check(UNPRESSED),
        skins=served.skins,
        interface=next(iter(served.skins)),
    )
    if served.parts is not None:
        frequencies = served.parts.setup.frequency
        if beyond := outside_band(meter.model, frequencies, meter.band):
            meter.worker.end()
            others = [name for name in reaching(frequencies) if name in VIRTUAL_MODELS]
            instead = f", or give --model {others[0]}" if others else ""
            name = served.parts.skin.name
            raise InputError(f"{name}: {beyond}; change `sweep.frequencies`{instead}")
    meter.worker.submit(served.skin.impedance, meter.press, served.frequency).result()
    return meter


def notes(meter: Instrument, served: ServedSkin) -> list[str]:
    """What a user must know of a served meter: how it differs from the real one."""
    from ...simulator.scene.meter import built_in, meter_names

    found = [meter.note] if meter.note else []
    parts, named = served.parts, meter.model != VIRTUAL_MODEL and meter.model in meter_names()
    if parts is not None and parts.meter.readout.multisine is not None:
        found.append(
            f"the reader of {parts.skin.name} is a multisine, and this meter reads one frequency "
            "after the other in its own time; --reader FILE sends whole frames"
        )
    elif parts is not None and named and not parts.meter.readout.exact:
        if parts.meter.readout != built_in(meter.model):
            found.append(
                f"readings have the errors that the readout of {parts.skin.name} states; "
                f'readout = "{meter.model}" in the scene takes the data sheet of this meter'
            )
    return found


def reader(served: ServedSkin, line_format: LineFormat, pace: float = 1.0) -> VirtualReader:
    """Virtual reader that sends lines of this format, with filled caches.

    Raises InputError for another pace, for a recorded skin, or if the format does not fit it.
    """
    from .virtual_reader import VirtualReader

    _check_pace(pace)
    if served.parts is None:
        raise InputError("a virtual reader needs --scene: recorded sweeps have no lines in time")
    kind = served.parts.setup.kind
    if (line_format.kind is IMPEDANCE) == (kind is not IMPEDANCE):
        raise InputError(
            f"{served.parts.skin.name}: reads the {kind.name}, and the reader's "
            f"file describes the {line_format.kind.name}; change one of them"
        )
    _check_rate(served.parts, line_format)
    own = served.parts.setup.own
    whole = tuple(served.parts.setup.frequency.tolist())
    made = VirtualReader(
        line_format=line_format,
        readout=served.readout,
        frequencies={name: tuple(own.get(name, whole)) for name in served.skins},
        pace=pace,
        press=served.skin.check(UNPRESSED),
        skins=served.skins,
        interface=next(iter(served.skins)),
    )
    made.worker.submit(served.skin.impedance, made.press, served.frequency).result()
    return made


def _check_rate(parts: SceneParts, line_format: LineFormat) -> None:
    """Raises InputError if a reader sends lines faster than a multisine has frames."""
    if parts.meter.readout.multisine is None:
        return
    interfaces = len(parts.setup.interfaces)
    lines = (interfaces if line_format.terminal else 1) * (
        1 if line_format.lines == "sweeps" else len(parts.setup.frequency)
    )
    fastest = lines / (interfaces * parts.meter.readout.multisine.seconds)
    if line_format.rate > fastest * (1 + ROUNDING):
        raise InputError(
            f"`rate` of the reader's file must be <= {fastest:.6g} lines per second, as a sweep of "
            f"{parts.skin.name} takes "
            f"{1e3 * interfaces * parts.meter.readout.multisine.seconds:.6g} ms, got "
            f"{line_format.rate:g}"
        )


def _check_pace(pace: float) -> None:
    if not 0 <= pace <= 100:
        raise InputError(f"`pace` must be in [0, 100], got {pace:g}")
