"""The virtual meter's own switch, turned through its control port."""

from __future__ import annotations

from dataclasses import dataclass

from ..control_client import send_request
from ..meter.errors import PressError
from .errors import NoSwitchError


@dataclass(frozen=True)
class VirtualSwitch:
    """Switch between a virtual meter and the interfaces of its skin. control: HOST:PORT."""

    control: str

    def put(self, position: str, /) -> None:
        """Turn to an interface. Raises InputError if the skin lacks it."""
        self._ask("select", interface=position)

    def reported_position(self) -> str:
        """The connected interface."""
        return str(self._ask("state")["interface"])

    def close(self) -> None:
        """Do nothing: there is no connection to close."""

    def _ask(self, do: str, **given: str):
        try:
            return send_request(self.control, do, **given)
        except PressError as error:
            raise NoSwitchError(str(error)) from error
