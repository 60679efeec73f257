"""Common part of virtual meters and readers: the press of the skin, the clock and faults."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...simulator.sweeps import UNPRESSED
from ..event_counter import Report
from .faults import Faults
from .worker import Worker

if TYPE_CHECKING:
    from .clients import Client
    from .measurement import Skin


@dataclass(kw_only=True)
class VirtualDevice(ABC):
    """A device at a skin, shared by clients. pace: factor on all times; 1: real, 0: none.

    skins: by interface, for a switch; interface: the connected one. report_failure: reports why the
    skin has no reading. report: takes faults of clients.
    """

    pace: float = 1.0
    press: str = UNPRESSED
    faults: Faults = field(default_factory=Faults)
    worker: Worker = field(default_factory=Worker)
    skins: Mapping[str, Skin] = field(default_factory=dict)
    interface: str = ""
    report_failure: Callable[[str], None] = lambda text: None
    report: Report = lambda kind, text: None

    @property
    @abstractmethod
    def skin(self) -> Skin:
        """A skin, by which a press is checked."""

    @property
    @abstractmethod
    def shown_settings(self) -> dict[str, Any]:
        """Settings that the control port shows."""

    @property
    @abstractmethod
    def shown_reading(self) -> dict[str, Any] | None:
        """The latest reading, for a page; None if there is none."""

    @abstractmethod
    async def serve(self, client: Client) -> None:
        """Serve one client until it leaves."""

    @abstractmethod
    def connect(self, interface: str) -> None:
        """Connect one of `skins`. Raises InputError if the device has no switch."""

    @abstractmethod
    def changed(self) -> None:
        """Note a change that affects readings."""

    @property
    def now(self) -> float:
        """Time of the loop's clock, s."""
        return asyncio.get_running_loop().time()
