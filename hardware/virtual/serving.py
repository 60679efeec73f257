"""Serving of a virtual meter until a signal ends it."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.sweeps import InputError
from ..page.page_address import LOOPBACK
from .control import ControlPort
from .meter_server import Ports, open_ports
from .press_routines import Routine, press_at_random, press_by_script, read_script

if TYPE_CHECKING:
    from ..page.page_address import PageAddress
    from ..page.page_document import PageDocument
    from .served_skin import ServedSkin
    from .virtual_device import VirtualDevice


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
