"""Virtual meter or reader on TCP: one port for its language or lines, one control port."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass

from ..page.page_document import LOOPBACK
from ..tokens import stored_token
from .clients import Clients, open_port
from .control import ControlPort
from .virtual_device import VirtualDevice


@dataclass(frozen=True)
class Ports:
    """Ports of a virtual meter."""

    host: str
    meter: int
    control: int

    @property
    def resource(self) -> str:
        """The meter's VISA resource."""
        return f"TCPIP0::{self.host}::{self.meter}::SOCKET"

    @property
    def line_resource(self) -> str:
        """Resource of a virtual reader, which sends lines."""
        return f"tcp:{self.host}:{self.meter}"


@asynccontextmanager
async def open_ports(
    device: VirtualDevice, control: ControlPort, host: str, port: int, control_port: int
) -> AsyncIterator[Ports]:
    """Open both ports while the block runs. Port 0 takes any free port.

    The control port is always on the loopback. Its token is stored for the user's own commands
    while it listens. Raises InputError if a port is not available.
    """

    async with AsyncExitStack() as stack:
        report = device.report
        meter = await open_port(stack, Clients(device.serve, "meter's port", report), host, port)
        steering = Clients(control.serve, "control port", report)
        steered = await open_port(stack, steering, LOOPBACK, control_port)
        try:
            stack.enter_context(stored_token(control.token, steered))
        except (OSError, RuntimeError) as error:
            at = f"{control.token}@{LOOPBACK}:{steered}"
            report("tokens not stored", f"token not stored ({error}); commands need --control {at}")
        for task in control.background():
            stack.callback(task.cancel)
        yield Ports(host, meter, steered)


@contextmanager
def run_in_thread(
    device: VirtualDevice,
    control: ControlPort | None = None,
    host: str = LOOPBACK,
    port: int = 0,
    control_port: int = 0,
) -> Iterator[Ports]:
    """Run the virtual meter in a thread while the block runs. Raises the errors of `open_ports`."""
    loop, stack = asyncio.new_event_loop(), AsyncExitStack()
    entered = stack.enter_async_context(
        open_ports(device, control or ControlPort(device), host, port, control_port)
    )
    thread = threading.Thread(target=loop.run_forever, name="virtual meter", daemon=True)
    thread.start()
    try:
        yield asyncio.run_coroutine_threadsafe(entered, loop).result()
    finally:
        asyncio.run_coroutine_threadsafe(_shut_down(stack), loop).result()
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
        device.worker.shutdown()


async def _shut_down(stack: AsyncExitStack) -> None:
    await stack.aclose()
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
