"""Virtual meter or reader on TCP: a port for its language or lines, and a control port.

The control port takes one JSON object a line, each answered by one: {"do": "press", "press":
"2,3"}, {"do": "select", "interface": "left"}, {"do": "misbehave", "kind": "late", "times": 2,
"seconds": 1.5}, {"do": "depths"} of the press, {"do": "state"}. Each also has the key "token"; a
client that sends another token is disconnected.
"""

from __future__ import annotations

import asyncio
import json
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from typing import Any

from ...simulator.sweeps import InputError, ToleranceError
from ..page.page_document import LOOPBACK
from ..tokens import new_token, same_token, stored_token
from .clients import Client, Clients, open_port
from .virtual_device import Fault, VirtualDevice

UNKNOWN_TOKEN = (
    "the token of this request is not the virtual meter's; commands of the user who serves it find "
    "the token on the same computer, all others need TOKEN@HOST:PORT"
)


@dataclass
class ControlPort:
    """Controls one meter. routines: automatic presses, started with the server.

    token: required in each request.
    """

    instrument: VirtualDevice
    routines: tuple[Callable[[ControlPort], Coroutine[Any, Any, None]], ...] = ()
    tasks: list[asyncio.Task] = field(default_factory=list)
    token: str = field(default_factory=new_token, repr=False)

    def background(self) -> list[asyncio.Task]:
        """Start the routines."""
        self.tasks = [asyncio.create_task(routine(self)) for routine in self.routines]
        return self.tasks

    async def press(self, text: str) -> str:
        """Press the skin until the next press.

        Raises InputError, and ToleranceError if the depth of a force is not found.
        """
        meter = self.instrument
        loop = asyncio.get_running_loop()
        held = loop.run_in_executor(meter.worker, meter.skin.hold, text, meter.now)
        meter.press = await held
        meter.changed()
        return meter.press

    async def serve(self, client: Client) -> None:
        """Answer a client's requests, one per line, until one has a wrong token."""
        async for line in client.lines():
            request = _request(line)
            known = request is None or same_token(request.pop("token", ""), self.token)
            answer = await self._answer(request) if known else {"error": UNKNOWN_TOKEN}
            await client.say((json.dumps(answer) + "\n").encode("ascii"))
            if not known:
                self.instrument.report(
                    "requests without the token",
                    "control port: refused a request without its token",
                )
                return

    async def _answer(self, request: dict[str, Any] | None) -> dict[str, Any]:
        if request is None:
            return {"error": "unknown request: it must be a JSON object on one line"}
        try:
            return {"ok": await self._done(**request)}
        except (InputError, ToleranceError) as error:
            return {"error": str(error)}
        except (ValueError, TypeError, RecursionError) as error:
            return {"error": f"unknown request: {error}"}

    async def _done(self, do: str, **given: Any) -> Any:
        if do == "press":
            return await self.press(str(given["press"]) if "press" in given else "")
        if do == "misbehave":
            fault = Fault(**given)
            self.instrument.faults.add(fault)
            return fault.kind
        if do == "depths":
            loop, meter = asyncio.get_running_loop(), self.instrument
            return await loop.run_in_executor(meter.worker, meter.skin.depths, meter.press)
        if do == "state":
            return self.state()
        if do == "select":
            return self._select(**given)
        raise InputError(f"`do` must be press, depths, select, misbehave or state, got {do!r}")

    def _select(self, interface: str) -> str:
        """Turn the switch; the state shows the new interface after the turn."""
        meter = self.instrument
        if interface not in meter.skins:
            known = ", ".join(meter.skins)
            raise InputError(f"the skin has the interfaces {known}, got {interface!r}")
        fault = meter.faults.take("slow", "stuck")
        if fault is None:
            meter.connect(interface)
        elif fault.kind == "slow":
            asyncio.get_running_loop().call_later(fault.seconds, meter.connect, interface)
        return interface

    def state(self) -> dict[str, Any]:
        """Press, interface, settings and pending faults."""
        return {
            "press": self.instrument.press,
            "interface": self.instrument.interface,
            **self.instrument.shown_settings,
            "faults": [fault.kind for fault in self.instrument.faults.waiting],
        }

    def shown(self) -> dict[str, Any]:
        """State of the page: press, interface, and the latest reading if it has numbers."""
        meter = self.instrument
        state = {
            "press": meter.press,
            "interface": meter.interface,
            "reading": meter.shown_reading,
        }
        return {"kind": "skin", "faults": self.state()["faults"], **state}


def _request(line: str | None) -> dict[str, Any] | None:
    try:
        request = json.loads(line or "")
    except (ValueError, RecursionError):
        return None
    return request if isinstance(request, dict) else None


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
