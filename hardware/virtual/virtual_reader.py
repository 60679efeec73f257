"""Virtual reader: streams sweeps of its skin to each client, with the faults of real devices."""

from __future__ import annotations

import asyncio
import cmath
import json
import math
import re
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...simulator.meters.accuracy_table import ReadingConditions
from ...simulator.sweeps import InputError
from ..reader.line_format import CHECKSUM_DIGITS, LineFormat, ReaderInterface, checksum
from ..reader.line_port import MAX_LINE
from ..reader.reader_driver import VIRTUAL_READER, ordered_frequencies
from .virtual_device import GARBAGE, ON_LINES, Fault, VirtualDevice

if TYPE_CHECKING:
    from .clients import Client
    from .measurement import Readout, Skin

Values = Mapping[str, Sequence[complex]]
"""Readings by the name of their interface, one for each frequency of the line."""


def line_text(
    line_format: LineFormat,
    frequencies: Sequence[float],
    values: Values,
    count: int,
    sweep: int,
    seconds: float,
) -> str:
    """One line with these readings, ohm or gains, at frequencies in Hz.

    count, sweep: numbers of the line and of the sweep. seconds: since the start of the device.
    """
    fields: dict[str, Any] = {
        line_format.count: count % (line_format.count_limit or count + 1),
        line_format.sweep: sweep,
        line_format.time: round(1e3 * seconds),
    }
    if line_format.frequency:
        sent = [each / line_format.frequency_scale for each in frequencies]
        fields[line_format.frequency] = _listed(sent, line_format)
    for interface in line_format.interface or (None,):
        fields |= _interface_fields(line_format, interface, frequencies, values)
    fields.pop("", None)
    body = _json(fields) if line_format.format == "json" else _csv(fields, line_format)
    return body + _checksum(body, line_format)


def _interface_fields(
    line_format: LineFormat,
    interface: ReaderInterface | None,
    frequencies: Sequence[float],
    values: Values,
) -> dict[str, Any]:
    name = interface.name if interface else next(iter(values))
    if name not in values:
        return {}
    parts = line_format.fields_of(interface)
    sent = [
        _parts(value, frequency, line_format)
        for value, frequency in zip(values[name], frequencies, strict=True)
    ]
    found: dict[str, Any] = {
        field: _listed([each[part] for each in sent], line_format) for part, field in parts.items()
    }
    if interface and interface.label:
        found[line_format.terminal] = interface.label
    return found


def _parts(value: complex, frequency: float, line_format: LineFormat) -> dict[str, float]:
    """All parts of a reading in the units of the lines."""
    shown = value * (line_format.amplitude or 1.0) / line_format.scale
    phase = cmath.phase(value)
    omega = 2 * math.pi * frequency
    parts = {"real": shown.real, "imaginary": shown.imag, "magnitude": abs(shown)}
    if line_format.unit == "bit":
        parts = {part: float(round(each)) for part, each in parts.items()}
    return {
        **parts,
        "phase": math.degrees(phase) if line_format.phase_unit == "deg" else phase,
        "Cp": (1 / value).imag / omega,
    }


def _listed(values: Sequence[float], line_format: LineFormat) -> float | list[float]:
    rounded = [float(f"{value:.9g}") for value in values]
    return rounded if line_format.lines == "sweeps" else rounded[0]


def _json(fields: Mapping[str, Any]) -> str:
    nested: dict[str, Any] = {}
    for name, value in fields.items():
        *outer, last = name.split(".")
        inner = nested
        for key in outer:
            inner = inner.setdefault(key, {})
        inner[last] = value
    return json.dumps(nested)


def _csv(fields: Mapping[str, Any], line_format: LineFormat) -> str:
    columns = [fields.get(name, 0) for name in line_format.cells]
    cells = [each for value in columns for each in (value if isinstance(value, list) else [value])]
    return line_format.separator.join(map(str, cells))


def _checksum(body: str, line_format: LineFormat) -> str:
    kind = line_format.checksum
    return f"*{checksum(body, kind):0{CHECKSUM_DIGITS[kind]}X}" if kind else ""


RANGE = 1
"""Number of the only range: a reader has one."""
BOOT_TEXT = "ets: virtual reader boots"
BOOT_SECONDS, FAILURE_SECONDS = 0.05, 0.2
LAST_NUMBER = re.compile(r"[-+.\de]+(?=[^\d]*$)")


@dataclass
class VirtualReader(VirtualDevice):
    """A reader of all interfaces of a skin. frequencies: Hz, by interface in the file's order."""

    line_format: LineFormat
    readout: Readout
    frequencies: Mapping[str, Sequence[float]]

    def __post_init__(self) -> None:
        """Raises InputError if the format does not fit the interfaces and frequencies."""
        ordered = ordered_frequencies(self.line_format, self.frequencies)
        highest = self.line_format.begins == "highest"
        self.frequencies = {
            name: tuple(sorted(own.tolist(), reverse=highest)) for name, own in ordered.items()
        }
        listed = self.line_format.frequencies
        different = {tuple(sorted(own)) for own in self.frequencies.values()}
        if listed and different != {tuple(sorted(listed))}:
            raise InputError("`frequencies` of the reader's file must be those of the scene")
        if len(different) > 1 and not self.line_format.terminal:
            raise InputError(
                "interfaces with frequencies of their own need `terminal` and a `label` each in "
                "the reader's file"
            )
        if listed:
            self.frequencies = dict.fromkeys(self.frequencies, listed)

    @property
    def skin(self) -> Skin:
        """The skin at its first interface."""
        return next(iter(self.skins.values()))

    @property
    def shown_settings(self) -> dict[str, Any]:
        """Name of the reader."""
        return {"reader": self.line_format.name}

    @property
    def shown_reading(self) -> dict[str, Any] | None:
        """None: a page of the skin shows no readings of a reader."""
        return None

    def connect(self, interface: str) -> None:
        """Raises InputError: all interfaces are read at once."""
        raise InputError("the virtual reader reads all interfaces at once and has no switch")

    def changed(self) -> None:
        """Do nothing: the next reading is of the new press."""

    async def serve(self, client: Client) -> None:
        """Stream lines to a client until it leaves, from its start command on if there is one."""
        running = asyncio.Event()
        if not self.line_format.start:
            running.set()
        await client.say(f"{VIRTUAL_READER}\n".encode("ascii"))
        stream = asyncio.create_task(LineStream(self, client, running).run())
        commands = asyncio.create_task(self._obey(client, running))
        try:
            done, _ = await asyncio.wait({stream, commands}, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in (stream, commands):
                task.cancel()
            await asyncio.gather(stream, commands, return_exceptions=True)

    async def readings(self, places: Mapping[str, Sequence[float]]) -> Values:
        """Readings with errors at frequencies in Hz by interface. Raises the skin's errors."""
        presses: dict[str, Any] = {
            name: self.skins[name].momentary(self.press, self.now) for name in places
        }

        def measured() -> Values:
            return {
                name: [
                    self.readout(
                        self.skins[name].impedance(presses[name], f), ReadingConditions(f, RANGE)
                    )
                    for f in own
                ]
                for name, own in places.items()
            }

        return await asyncio.get_running_loop().run_in_executor(self.worker, measured)

    async def _obey(self, client: Client, running: asyncio.Event) -> None:
        async for line in client.lines():
            if line and line == self.line_format.start:
                running.set()
            elif line and line == self.line_format.stop:
                running.clear()


class _RestartedDevice(Exception):  # noqa: N818
    """The device restarted within a sweep."""


class LineStream:
    """Lines to one client."""

    def __init__(self, reader: VirtualReader, client: Client, running: asyncio.Event) -> None:
        self._reader, self._client, self._running = reader, client, running
        self._format, self._kept = reader.line_format, ""
        self._boot()

    async def run(self) -> None:
        """Send sweep after sweep."""
        while True:
            await self._running.wait()
            try:
                async for places in self._places():
                    await self._send(await self._line(places))
            except _RestartedDevice:
                continue
            except (ArithmeticError, ValueError, RuntimeError) as failure:
                self._reader.report_failure(
                    f"press {self._reader.press}: no reading: {failure} ({type(failure).__name__})"
                )
                await asyncio.sleep(FAILURE_SECONDS)
            self._sweep += 1

    def _boot(self) -> None:
        self._count = self._sweep = 0
        self._booted, self._due = self._reader.now, self._reader.now

    async def _places(self) -> AsyncIterator[Mapping[str, Sequence[float]]]:
        """Frequencies by interface of each line of a sweep, at the time of the line."""
        given, frequencies = self._format, self._reader.frequencies
        each = (
            [{name: own} for name, own in frequencies.items()] if given.terminal else [frequencies]
        )
        for places in each:
            own = next(iter(places.values()))
            whole = given.lines == "sweeps"
            for here in [own] if whole else [(frequency,) for frequency in own]:
                self._due = max(self._due + self._reader.pace / given.rate, self._reader.now)
                await asyncio.sleep(max(0.0, self._due - self._reader.now))
                if not self._running.is_set():
                    return
                yield dict.fromkeys(places, here)

    async def _line(self, places: Mapping[str, Sequence[float]]) -> str:
        values = await self._reader.readings(places)
        self._count += 1
        return self._text(places, values, self._sweep)

    def _text(self, places: Mapping[str, Sequence[float]], values: Values, sweep: int) -> str:
        own = next(iter(places.values()))
        seconds = self._reader.now - self._booted
        return line_text(self._format, own, values, self._count - 1, sweep, seconds)

    async def _send(self, line: str) -> None:
        fault = self._reader.faults.take(*ON_LINES)
        sent = f"{line}\n" if fault is None else await self._faulty(line, fault)
        self._kept = line
        if sent:
            await self._client.say(sent.encode("latin-1"))

    async def _restart(self, cut: str) -> None:
        """Send a line up to the middle of its last number, and the banner of the start.

        A line end comes before the banner, so that the number looks complete. Raises
        _RestartedDevice.
        """
        await asyncio.sleep(BOOT_SECONDS)
        await self._client.say(f"{cut}\n{self._format.banner or BOOT_TEXT}\n".encode("ascii"))
        self._boot()
        if self._format.start:
            self._running.clear()
        raise _RestartedDevice

    async def _faulty(self, line: str, fault: Fault) -> str:
        """What is sent instead of a line."""
        if fault.kind == "drop":
            raise ConnectionAbortedError("the fault `drop` closes the connection")
        if fault.kind == "late":
            await asyncio.sleep(fault.seconds)
        if fault.kind == "restart":
            last = LAST_NUMBER.search(line)
            await self._restart(line[: sum(last.span()) // 2 if last else len(line) // 2])
        if fault.kind == "miscount":
            self._count += 5
            return f"{line}\n"
        instead = {
            "silent": "",
            "garbage": GARBAGE.decode("latin-1"),
            "half": line[: len(line) // 2],
            "repeat": f"{line}\n{line}\n",
            "interleave": f"{self._kept}\n{line}\n",
            "endless": "9" * (2 * MAX_LINE) + "\n",
            "nan": f"{LAST_NUMBER.sub('NaN', line)}\n",
        }
        return instead.get(fault.kind, f"{line}\n")
