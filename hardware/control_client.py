"""Steering a virtual meter from another process, through its control port."""

from __future__ import annotations

import json
import re
import socket
from typing import Any, NamedTuple

from ..simulator.sweeps import InputError
from .meter.errors import PressError
from .tokens import TOKEN, read_token

ADDRESS = re.compile(rf"(?:(?P<token>{TOKEN.pattern})@)?(?P<host>[^:@\s]+):(?P<port>[0-9]{{1,5}})")
OWN_COMPUTER = ("127.0.0.1", "localhost")
"""Hosts that are sent the token in the user's file: no other computer learns it."""


class ControlEndpoint(NamedTuple):
    """Where a control port is, and the token that it asks for, empty where none is known."""

    host: str
    port: int
    token: str


def checked_address(text: str, must: str) -> ControlEndpoint:
    """The address in [TOKEN@]HOST:PORT; without a token it is looked up for this computer's ports.

    Raises InputError saying what it must be.
    """
    match = ADDRESS.fullmatch(text)
    if match is None or int(match["port"]) > 65535:
        raise InputError(f"{must}, got {text!r}")
    host, port = match["host"], int(match["port"])
    return ControlEndpoint(
        host, port, match["token"] or (read_token(port) if host in OWN_COMPUTER else "")
    )


def send_request(control: str, do: str, **given: Any) -> Any:
    """What the virtual meter answers to a request (see `control`).

    control: [TOKEN@]HOST:PORT. Raises InputError where the address or the request is refused,
    PressError where no virtual meter answers there.
    """
    address = checked_address(control, "`control` must be HOST:PORT or TOKEN@HOST:PORT")
    request = {"do": do, "token": address.token, **given}
    try:
        with socket.create_connection(address[:2], timeout=30) as line:
            line.sendall((json.dumps(request) + "\n").encode())
            answer = line.makefile("rb").readline(1 << 16)
    except OSError as error:
        raise _absent(address, str(error)) from error
    return _result(address, answer)


def _result(address: ControlEndpoint, line: bytes) -> Any:
    """The result in an answer. Raises InputError where it is a refusal, PressError where none."""
    try:
        answer = json.loads(line)
    except (ValueError, RecursionError):
        answer = None
    if isinstance(answer, dict) and "error" in answer:
        raise InputError(str(answer["error"]))
    if isinstance(answer, dict) and "ok" in answer:
        return answer["ok"]
    raise _absent(address, "what answers is something else" if line else "it hung up")


def _absent(address: ControlEndpoint, why: str) -> PressError:
    return PressError(
        f"no virtual meter answers at {address.host}:{address.port} ({why}); check that "
        "`rcskin meter serve` runs, and the control port that it printed"
    )
