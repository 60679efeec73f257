"""Serving of a virtual meter until a signal ends it."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.meters.accuracy_table import DERIVED_TABLE, read_table
from ...simulator.meters.meter_bands import VIRTUAL_MODEL, outside_band
from ...simulator.sweeps import UNPRESSED, InputError
from ...simulator.sweeps.reading_quantities import IMPEDANCE
from ..page.page_address import LOOPBACK
from .control import ControlPort
from .instrument import Instrument
from .measurement import MeasurementSetup, Readout
from .meter_server import Ports, open_ports
from .press_routines import Routine, press_at_random, press_by_script, read_script
from .recorded_skin import RecordedSkin, exact_readout
from .virtual_models import virtual_model

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.scene.scene import Scene
    from ..page.page_address import PageAddress
    from ..page.page_document import PageDocument
    from ..reader.line_format import LineFormat
    from .measurement import Skin
    from .reader.virtual_reader import VirtualReader
    from .virtual_device import VirtualDevice

ROUNDING = 1e-9


@dataclass(frozen=True)
class ServedSkin:
    """A served skin at its interfaces, the first of which is connected, and the meter's readout.

    rows, columns: of pixels. frequency: Hz, of the first reading, which compiles and fills caches.
    scene: with the measured readings, if the skin is simulated.
    """

    skins: Mapping[str, Skin]
    readout: Readout
    rows: int
    columns: int
    frequency: float
    scene: Scene | None = None

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


def simulated(scene: Scene, interfaces: Sequence[str] | None = None, seed: int = 1) -> ServedSkin:
    """Simulated skin of a scene at these or all interfaces, with the errors of a session.

    Raises InputError for other interfaces.
    """
    from ...simulator.measure.specimen import MeterSessionErrors, Specimen
    from ...simulator.scene.readings.changed_readings import (
        checked_interfaces,
        restricted_to_interfaces,
    )

    names = checked_interfaces(interfaces, scene)
    read = restricted_to_interfaces(scene, names)
    whole, errors = Specimen(scene, names[0]), MeterSessionErrors(scene, seed)
    return ServedSkin(
        {name: whole.at(name) for name in names},
        lambda Z, conditions: errors.read(Z, conditions.frequency, conditions.range),
        *scene.pixels.shape,
        read.sweep.frequencies[0],
        read,
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
    if served.scene is not None and served.scene.reading.gain:
        raise InputError(
            f"{served.scene.name}: reads gains, and a meter reads impedances; serve it by --reader"
        )
    meter = virtual_model(model)(
        MeasurementSetup(served.skin, served.readout, read_table(accuracy)),
        pace=pace,
        press=served.skin.check(UNPRESSED),
        skins=served.skins,
        interface=next(iter(served.skins)),
    )
    if served.scene is not None:
        frequencies = served.scene.sweep.frequencies
        if beyond := outside_band(meter.model, frequencies, meter.band):
            meter.worker.end()
            raise InputError(f"{served.scene.name}: {beyond}; change `sweep.frequencies`")
    meter.worker.submit(served.skin.impedance, meter.press, served.frequency).result()
    return meter


def notes(meter: Instrument, served: ServedSkin) -> list[str]:
    """What a user must know of a served meter: how it differs from the real one."""
    from ...simulator.scene.readout.meter import meter_names

    found = [meter.note] if meter.note else []
    scene, named = served.scene, meter.model != VIRTUAL_MODEL and meter.model in meter_names()
    if scene is not None and scene.readout.multisine is not None:
        found.append(
            f"the reader of {scene.name} is a multisine, and this meter reads one frequency after "
            "the other in its own time; --reader FILE sends whole frames"
        )
    elif scene is not None and named and not scene.readout.exact:
        if scene.readout != scene.with_({"readout": meter.model}).readout:
            found.append(
                f"readings err as the readout of {scene.name} states; "
                f'readout = "{meter.model}" in the scene takes the data sheet of this meter'
            )
    return found


def reader(served: ServedSkin, line_format: LineFormat, pace: float = 1.0) -> VirtualReader:
    """Virtual reader that sends lines of this format, with filled caches.

    Raises InputError for another pace, for a recorded skin, or if the format does not fit it.
    """
    from .reader.virtual_reader import VirtualReader

    _check_pace(pace)
    if served.scene is None:
        raise InputError("a virtual reader needs --scene: recorded sweeps have no lines in time")
    if (line_format.kind is IMPEDANCE) == served.scene.reading.gain:
        raise InputError(
            f"{served.scene.name}: reads the {served.scene.reading.kind.name}, and the reader's "
            f"file describes the {line_format.kind.name}; change one of them"
        )
    _check_rate(served.scene, line_format)
    own = served.scene.reading.own
    whole = tuple(served.scene.frequencies.tolist())
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


def _check_rate(scene: Scene, line_format: LineFormat) -> None:
    """Raises InputError if a reader sends lines faster than a multisine has frames."""
    if scene.readout.multisine is None:
        return
    interfaces = len(scene.interfaces)
    lines = (interfaces if line_format.terminal else 1) * (
        1 if line_format.lines == "sweeps" else len(scene.frequencies)
    )
    fastest = lines / (interfaces * scene.readout.multisine.seconds)
    if line_format.rate > fastest * (1 + ROUNDING):
        raise InputError(
            f"`rate` of the reader's file must be <= {fastest:.6g} lines per second, as a sweep of "
            f"{scene.name} takes {1e3 * interfaces * scene.readout.multisine.seconds:.6g} ms, got "
            f"{line_format.rate:g}"
        )


def _check_pace(pace: float) -> None:
    if not 0 <= pace <= 100:
        raise InputError(f"`pace` must be in [0, 100], got {pace:g}")


def routines(
    served: ServedSkin, script: Path | None, random: float | None, seed: int
) -> tuple[Routine, ...]:
    """Automatic presses: by a script's file, or at random every `random` s."""
    if script and random is not None:
        raise InputError("`script` and `random` cannot both press the skin")
    if script:
        return (press_by_script(read_script(script, served.skin)),)
    if random is not None:
        import numpy as np

        generator = np.random.default_rng(seed)
        return (press_at_random(served.pixels, random, generator),)
    return ()


@dataclass(frozen=True)
class PageOptions:
    """A page on which the skin is pressed. on_listening: called with its address."""

    document: PageDocument
    port: int
    on_listening: Callable[[PageAddress], None]


def serve(
    meter: VirtualDevice,
    press_routines: tuple[Routine, ...],
    on_listening: Callable[[Ports], None],
    host: str = LOOPBACK,
    port: int = 3500,
    control_port: int = 3501,
    page_options: PageOptions | None = None,
) -> None:
    """Serve until a signal ends the process. on_listening: called when the ports are open.

    Raises InputError if a port is not available.
    """

    async def open_(stack: AsyncExitStack) -> None:
        control = ControlPort(meter, press_routines)
        on_listening(
            await stack.enter_async_context(open_ports(meter, control, host, port, control_port))
        )
        if page_options:
            page_options.on_listening(
                await stack.enter_async_context(serve_page(control, page_options))
            )

    asyncio.run(_run_until_signal(open_))
    meter.worker.end()


@asynccontextmanager
async def serve_page(control: ControlPort, page_options: PageOptions) -> AsyncIterator[PageAddress]:
    """Serve the skin's page while the block runs. Raises InputError if the port is taken."""
    from ..page.latest_state import LatestState
    from ..page.page_server import PageServer
    from ..page.state_watch import keep_updated, post_if_changed

    board = LatestState()

    async def press(text: str) -> str:
        full = await control.press(text)
        post_if_changed(board, control.shown())
        return full

    async with PageServer(page_options.document, board, press).served(page_options.port) as address:
        watch = asyncio.create_task(keep_updated(board, control.shown))
        try:
            yield address
        finally:
            watch.cancel()


def _on_signal(number: signal.Signals, call: Callable[[], None], stack: AsyncExitStack) -> None:
    """Call a function in the loop at a signal, also on Windows, where loops take no signals.

    There, closing the stack restores the handler of before; a loop resets its own signals itself.
    """
    loop = asyncio.get_running_loop()
    try:
        loop.add_signal_handler(number, call)
    except NotImplementedError:
        before = signal.signal(number, lambda *_: loop.call_soon_threadsafe(call))
        stack.callback(signal.signal, number, before)


async def _run_until_signal(open_: Callable[[AsyncExitStack], Awaitable[None]]) -> None:
    stopped = asyncio.Event()
    async with AsyncExitStack() as stack:
        for end in (signal.SIGINT, signal.SIGTERM):
            _on_signal(end, stopped.set, stack)
        await open_(stack)
        await stopped.wait()
