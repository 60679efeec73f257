"""Serving of a virtual meter until a signal ends it."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.sweeps import UNPRESSED, InputError, ToleranceError, inputs
from ..page.page_document import LOOPBACK
from .meter_server import ControlPort, Ports, open_ports

if TYPE_CHECKING:
    from ..page.page_document import PageAddress, PageDocument
    from .measurement import Skin
    from .served_skin import ServedSkin
    from .virtual_device import VirtualDevice

MAX_SECONDS = 1e6
"""Longest script: eleven days."""
Routine = Callable[[ControlPort], Coroutine[Any, Any, None]]


def read_script(path: Path, skin: Skin) -> list[tuple[float, str]]:
    """(seconds from the start, press) from lines `SECONDS PRESS`; `#` begins a comment.

    Raises InputError with the file and the line for another form, times that do not ascend or that
    exceed MAX_SECONDS, or a press that the skin does not have.
    """
    lines = inputs.text(path, inputs.SETTINGS).splitlines()
    steps: list[tuple[float, str]] = []
    for number, line in enumerate(lines, start=1):
        words = line.split("#")[0].split(maxsplit=1)
        if not words:
            continue
        try:
            seconds, press = float(words[0]), skin.check(words[1].strip())
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from error
        except (ValueError, IndexError) as error:
            raise InputError(f"{path}: line {number}: must be SECONDS PRESS") from error
        if not (steps[-1][0] if steps else 0) <= seconds <= MAX_SECONDS:
            raise InputError(
                f"{path}: line {number}: times must ascend from 0 to {MAX_SECONDS:g} s, got "
                f"{words[0]}"
            )
        steps.append((seconds, press))
    return steps


def press_by_script(steps: list[tuple[float, str]]) -> Routine:
    """Press at these times; the last press stays."""

    async def routine(control: ControlPort) -> None:
        begun = control.instrument.now
        for seconds, press in steps:
            await asyncio.sleep(begun + seconds - control.instrument.now)
            await _press(control, press)

    return routine


def press_at_random(pixels: Sequence[str], seconds: float, random: np.random.Generator) -> Routine:
    """Press a random one of these pixels, or none, every `seconds`."""
    if not 0 < seconds <= 3600:
        raise InputError(f"`random` must be in (0, 3600] s, got {seconds:g}")

    async def routine(control: ControlPort) -> None:
        while True:
            await _press(control, str(random.choice([UNPRESSED, *pixels])))
            await asyncio.sleep(seconds)

    return routine


async def _press(control: ControlPort, press: str) -> None:
    """Press the skin. An impossible press is reported, and the press before stays."""
    try:
        await control.press(press)
    except (InputError, ToleranceError) as error:
        control.instrument.report_failure(str(error))


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
    from ..page.page_server import LatestState, PageServer, keep_updated, post_if_changed

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
